// Messages that go by a relay: taken, refused, lost, answered. Time is injected, nothing sleeps.
#include <doctest/doctest.h>

#include "services/router/test/test_relays.hpp"

using namespace trb;
using namespace trb::router;
using std::chrono::milliseconds;
using Seconds = std::chrono::seconds;

TEST_CASE("a message goes by the relay once, to whom it is for, and its answer comes back that way") {
  Triangle three;
  const std::uint64_t before = three.bee->count("relayed.received");
  const Relaying relaying = three.wrap(three.numbered("1"));
  CHECK(relaying.link == three.ant->link_to("cloud"));
  three.put(*three.ant, "cloud", relaying.message);
  three.fleet.run(milliseconds(100));
  CHECK(three.delivered() == 1);
  CHECK(three.bee->bus.back().message.source == "ant");
  CHECK(three.bee->bus.back().message.data == "1");
  CHECK(three.bee->count("relayed.received") == before + 1);
}

TEST_CASE("what is replayed, forged, late or for another boot is refused, each by a name of its own") {
  Triangle three;
  const auto now = three.fleet.now.utc.ns;
  const RelayedFrame good = three.frame(5, three.numbered("x"));
  three.hand_to_bee(three.signed_by_ant(good));
  CHECK(three.delivered() == 1);

  three.hand_to_bee(three.signed_by_ant(good));
  CHECK(three.bee->count("refused.relayed_replayed") == 1);
  RelayedFrame unproven = three.frame(6, three.numbered("x"));
  unproven.source_boot = 2;
  three.hand_to_bee(three.signed_by_ant(unproven));
  CHECK(three.bee->count("refused.relayed_replayed") == 2);

  SignedRecord forged = three.signed_by_ant(three.frame(6, three.numbered("x")));
  forged.payload.bytes.back() ^= 1;
  three.hand_to_bee(forged);
  CHECK(three.bee->count("refused.relayed_bad_signature") == 1);
  SignedRecord other = sign(kSignedRelayed, "ant", three.fleet.authority.fleet.id(),
                            encode(three.frame(6, three.numbered("x"))), three.cloud.keys.identity);
  three.hand_to_bee(other);
  CHECK(three.bee->count("refused.relayed_bad_signature") == 2);
  SignedRecord purpose = sign(kSignedResult, "ant", three.fleet.authority.fleet.id(),
                              encode(three.frame(6, three.numbered("x"))), three.ant->keys.identity);
  three.hand_to_bee(purpose);
  CHECK(three.bee->count("refused.relayed_bad_signature") == 3);

  RelayedFrame late = three.frame(6, three.numbered("x"));
  late.expires = now - 1;
  three.hand_to_bee(three.signed_by_ant(late));
  CHECK(three.bee->count("refused.relayed_late") == 1);
  RelayedFrame boot = three.frame(6, three.numbered("x"));
  boot.target_boot = 2;
  three.hand_to_bee(three.signed_by_ant(boot));
  CHECK(three.bee->count("refused.relayed_other_boot") == 1);

  Message theft = three.numbered("x");
  theft.source = "cloud";
  three.hand_to_bee(three.signed_by_ant(three.frame(7, theft)));
  CHECK(three.bee->count("refused.relayed_source_mismatch") == 1);
  Message astray = three.numbered("x");
  astray.target = "cat";
  three.hand_to_bee(three.signed_by_ant(three.frame(8, astray)));
  CHECK(three.bee->count("refused.relayed_wrong_target") == 1);
  RelayedFrame garbage = three.frame(9, three.numbered("x"));
  garbage.box.bytes = lock_relayed(relay_key(three.ant->keys.link, three.bee->keys.link.public_key), "nothing");
  three.hand_to_bee(three.signed_by_ant(garbage));
  CHECK(three.bee->count("refused.relayed_malformed") == 1);
  RelayedFrame foreign = three.frame(9, three.numbered("x"));
  foreign.box.bytes = lock_relayed(relay_key(three.ant->keys.link, three.cloud.keys.link.public_key), "nothing");
  three.hand_to_bee(three.signed_by_ant(foreign));
  CHECK(three.bee->count("refused.relayed_wrong_key") == 1);
  SignedRecord unknown = three.signed_by_ant(three.frame(10, three.numbered("x")));
  unknown.signer = "nobody";
  three.hand_to_bee(unknown);
  CHECK(three.bee->count("refused.relayed_unknown_signer") == 1);
  CHECK(three.delivered() == 1);

  three.hand_to_bee(three.signed_by_ant(three.frame(11, three.numbered("y"))));
  CHECK(three.delivered() == 2);
}

TEST_CASE("words of a link and of one node's own services are not taken by a relay") {
  Triangle three;
  std::uint64_t count = 20;
  for (const char* word : {"hello", "keep_alive", "goodbye", "relay_refused", "relayed", "neighbours", "execute"}) {
    CAPTURE(word);
    Message message = three.numbered("x");
    message.subtype = word;
    const std::uint64_t before = three.bee->count("refused.not_permitted");
    three.hand_to_bee(three.signed_by_ant(three.frame(++count, message)));
    CHECK(three.bee->count("refused.not_permitted") == before + 1);
  }
  CHECK(three.bee->link_to("cloud") == three.cloud_link);
}

TEST_CASE("a role's rights are the same by a relay: what only a robot can know is taken from no cloud") {
  Triangle three;
  three.fleet.keys("office") = three.fleet.authority.sign_node("office", Role::cloud);
  three.fleet.cut("office", "bee");
  three.fleet.cut("bee", "office");
  TestNode& office = three.fleet.start("office", {.beacon = false, .seeds = {"cloud"}});
  three.fleet.run(Seconds(3));
  REQUIRE(Triangle::route(*three.bee, "office", three.fleet)->via == "cloud");
  Message fault = three.numbered("x");
  fault.source = "office";
  fault.subtype = "robot_fault";
  auto relaying = office.core->relays().wrap(1, "bee", header_of(fault), encode_frame(fault), three.fleet.now);
  REQUIRE(relaying.ok());
  three.put(office, "cloud", relaying->message);
  three.fleet.run(milliseconds(100));
  CHECK(three.bee->count("refused.not_permitted") == 1);
}

TEST_CASE("a relay passes on what its own peer signed, one hop and no more, and a node that is none passes nothing") {
  Triangle three;
  const auto from_ant = [&](const SignedRecord& record) {
    three.put(*three.ant, "cloud", make_message(MessageType::information, "ant", "cloud", Relayed{record}));
  };
  const RelayedFrame frame = three.frame(30, three.numbered("x"));
  from_ant(sign(kSignedRelayed, "bee", three.fleet.authority.fleet.id(), encode(frame), three.bee->keys.identity));
  CHECK(three.cloud.count("refused.relayed_second_hop") == 1);
  RelayedFrame for_cat = frame;
  for_cat.target = "cat";
  three.hand_to_bee(three.signed_by_ant(for_cat));
  CHECK(three.bee->count("refused.relayed_no_relay") == 1);
  Message told = make_message(MessageType::information, "bee", "cloud", Neighbours{});
  three.put(*three.bee, "cloud", told);
  CHECK(three.cloud.count("refused.not_permitted") == 1);
}

TEST_CASE("a target that the relay has lost: who sent it is told at once; a message over 511 kB never leaves") {
  Triangle three;
  const Relaying relaying = three.wrap(three.command(*three.ant));
  three.fleet.stop("bee");
  three.fleet.run(milliseconds(20));
  Effects effects;
  three.cloud.core->links().on_ended(three.cloud.link_to("bee"), LinkEnd::disconnected, three.fleet.now, effects);
  three.fleet.carry_out(three.cloud, effects);
  three.put(*three.ant, "cloud", relaying.message);
  CHECK(three.cloud.count("dropped.peer_unreachable") == 1);
  three.fleet.run(milliseconds(200));
  CHECK(three.nacks(*three.ant) == std::vector<std::string>{"peer_unreachable"});
  CHECK(three.ant->relay_route("bee").relays.empty());
  const Message later = three.numbered("x");
  const auto gone = three.ant->core->relays().wrap(1, "bee", header_of(later), encode_frame(later), three.fleet.now);
  CHECK(gone.error().code == Errc::peer_unreachable);
  three.fleet.run(Seconds(4));
  CHECK(three.nacks(*three.ant).size() == 1);

  Triangle again;
  const Message huge = again.numbered(std::string(600'000, 'x'));
  const auto large = again.ant->core->relays().wrap(1, "bee", header_of(huge), encode_frame(huge), again.fleet.now);
  CHECK(large.error().code == Errc::too_large);
}

TEST_CASE("a cut that comes and goes: what is sent meanwhile arrives once or not at all, and nowhere else") {
  Triangle three;
  std::uint64_t number = 0;
  const auto send_for = [&](Duration time) {
    for (Duration spent{}; spent < time; spent += 5 * kStep) {
      three.say(++number);
      three.fleet.run(5 * kStep);
    }
  };
  for (int round = 0; round < 4; ++round) {
    three.fleet.heal();
    send_for(Seconds(7));
    CHECK(three.ant->link_to("bee") != 0);
    three.fleet.cut("ant", "bee");
    if (round % 2 == 0) three.fleet.cut("bee", "ant");
    send_for(Seconds(15));
    CHECK(Triangle::route(*three.ant, "bee", three.fleet)->via == "cloud");
  }
  std::map<Bytes, int> times;
  for (const Message& message : three.bee->delivered) ++times[message.data];
  for (const BusSend& send : three.bee->bus) {
    if (send.message.subtype == "numbered") ++times[send.message.data];
  }
  CHECK(times.size() > number / 3);
  for (const auto& [text, count] : times) CHECK_MESSAGE(count == 1, text);
  CHECK(three.cloud.delivered.empty());
  CHECK(three.cloud.told("numbered") == 0);
  CHECK(three.ant->told("numbered") == 0);
  CHECK(three.bee->count("refused.relayed_replayed") == 0);
}

TEST_CASE("what finds the relay's queue full, or this node's own, is told to who sent it, once") {
  Triangle three;
  const Relaying relaying = three.wrap(three.command(*three.ant));
  Effects effects;
  three.cloud.core->forwarding().on_own_unsent(relaying.message, Errc::queue_full, effects);
  REQUIRE(effects.list.size() == 1);
  CHECK(std::get<LinkSend>(effects.list[0]).link == three.cloud.link_to("ant"));
  three.fleet.carry_out(three.cloud, effects);
  three.fleet.run(Seconds(4));
  CHECK(three.nacks(*three.ant) == std::vector<std::string>{"queue_full"});

  const Relaying own = three.wrap(three.command(*three.ant));
  Effects stuck;
  three.ant->core->forwarding().on_own_unsent(own.message, Errc::queue_full, stuck);
  three.fleet.carry_out(*three.ant, stuck);
  three.fleet.run(Seconds(4));
  CHECK(three.nacks(*three.ant) == std::vector<std::string>{"queue_full", "queue_full"});

  Message nonsense = relaying.message;
  nonsense.data = "nothing";
  Effects none;
  three.cloud.core->forwarding().on_own_unsent(nonsense, Errc::queue_full, none);
  CHECK(none.list.empty());
}

TEST_CASE("the same name on another computer counts anew; the old computer's words stay refused") {
  Triangle three;
  three.hand_to_bee(three.signed_by_ant(three.frame(500, three.numbered("old"))));
  CHECK(three.delivered() == 1);
  const SignedRecord kept = three.signed_by_ant(three.frame(501, three.numbered("kept")));
  const TestKeys anew = three.fleet.authority.sign_node("ant", Role::robot, 2);
  const Neighbours told{{anew.record}, {}};
  three.put(three.cloud, "bee", make_message(MessageType::information, "cloud", "bee", told));
  three.hand_to_bee(kept);
  CHECK(three.bee->count("refused.relayed_bad_signature") == 1);
  RelayedFrame first = three.frame(1, three.numbered("new"));
  first.box.bytes =
      lock_relayed(relay_key(anew.link, three.bee->keys.link.public_key), encode_frame(three.numbered("new")));
  three.hand_to_bee(sign(kSignedRelayed, "ant", three.fleet.authority.fleet.id(), encode(first), anew.identity));
  CHECK(three.bee->count("refused.relayed_replayed") == 1);  // it has not shown that it is there
  CHECK(three.delivered() == 1);
}

TEST_CASE("a relay sees from whom and to whom, and nothing of what is said") {
  Triangle three;
  bool seen = false;
  int relayed = 0;
  three.fleet.meddle = [&](const std::string&, LinkId, std::uint64_t&, Message& message) {
    relayed += message.subtype == Relayed::kSubtype ? 1 : 0;
    seen = seen || message.data.find("open the gate") != Bytes::npos || message.data.find("numbered") != Bytes::npos;
    return true;
  };
  three.put(*three.ant, "cloud", three.wrap(three.numbered("open the gate")).message);
  three.fleet.run(milliseconds(100));
  CHECK(three.delivered() == 1);
  CHECK(relayed >= 2);
  CHECK_FALSE(seen);
}

TEST_CASE("a relay that loses a command in silence: who sent it is told that nobody confirms it") {
  Triangle three;
  bool lose = false;
  three.fleet.withhold = [&](const std::string& from, const Message& message) {
    return lose && from == "cloud" && message.subtype == Relayed::kSubtype;
  };
  three.put(*three.ant, "cloud", three.wrap(three.command(*three.ant)).message);
  three.fleet.run(Seconds(4));
  CHECK(three.nacks(*three.ant).empty());  // it came, and that was confirmed

  lose = true;
  three.put(*three.ant, "cloud", three.wrap(three.command(*three.ant)).message);
  three.fleet.run(milliseconds(2900));
  CHECK(three.nacks(*three.ant).empty());
  three.fleet.run(milliseconds(200));
  CHECK(three.nacks(*three.ant) == std::vector<std::string>{"not_confirmed"});
  three.fleet.run(Seconds(8));
  CHECK(Triangle::route(*three.ant, "bee", three.fleet)->state != "ONLINE");
  CHECK(three.nacks(*three.ant).size() == 1);
}

TEST_CASE("a relay that loses one of several is found out at the next word, and another relay is taken") {
  TestFleet fleet;
  fleet.cut("ant", "bee");
  fleet.cut("bee", "ant");
  fleet.start("cloud", {.beacon = false, .relay = true});
  fleet.start("dock", {.beacon = false, .seeds = {"cloud"}, .relay = true});
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"cloud", "dock"}});
  TestNode& bee = fleet.start("bee", {.beacon = false, .seeds = {"cloud", "dock"}});
  Triangle::serve(fleet, ant);
  Triangle::serve(fleet, bee);
  fleet.run(Seconds(4));
  const std::string first = Triangle::route(ant, "bee", fleet)->via;
  int lose = 1;
  fleet.withhold = [&](const std::string& from, const Message& message) {
    if (from != first || message.subtype != Relayed::kSubtype) return false;
    return decode<Relayed>(message.data)->record.signer == "ant" && lose-- > 0;
  };
  Triangle::say(fleet, ant, 1);
  fleet.run(kStep * 3);
  Triangle::say(fleet, ant, 2);
  fleet.run(milliseconds(400));
  CHECK(ant.told(Nack::kSubtype) == 1);
  CHECK(Triangle::route(ant, "bee", fleet)->via != first);
  Triangle::say(fleet, ant, 3);
  fleet.run(milliseconds(400));
  CHECK(bee.told("numbered") == 2);
  CHECK(ant.told(Nack::kSubtype) == 1);
}

TEST_CASE("a profile goes to who is reached by a relay, by its own word, at once and at each change") {
  Triangle three;
  Effects effects;
  effects.list.clear();
  const auto tell = [&](const std::string& model) {
    NodeProfile profile;
    profile.model = model;
    Effects said;
    three.ant->core->bus().on_hello(2, {"mode-adapter", {}, 5, 100, "1"}, "mode-adapter", three.fleet.now, said);
    three.ant->core->forwarding().on_bus_message(2, make_message(MessageType::information, "ant", "ant", profile),
                                                 three.fleet.now, said);
    three.fleet.carry_out(*three.ant, said);
    three.fleet.run(milliseconds(1200));
  };
  tell("ur3");
  CHECK(three.bee->peer("ant")->profile.model == "ur3");
  tell("ur5");
  CHECK(three.bee->peer("ant")->profile.model == "ur5");
}

TEST_CASE("a word by a relay that names a host instead of numbers is refused, and its sender not dialled there") {
  Triangle three;
  RelayAlive alive;
  alive.address = "hub.example:45000";
  Message word = make_message(MessageType::information, "ant", "bee", alive);
  word.remaining_ms = 5000;
  three.hand_to_bee(three.signed_by_ant(three.frame(1, word)));
  CHECK(three.bee->count("refused.relayed_bad_value") == 1);
  CHECK(three.bee->peer("ant")->address == three.fleet.address("ant"));
}

TEST_CASE(
    "a target that the relay has never heard of is told from one that it has lost; a stranger's words go nowhere") {
  Triangle three;
  RelayedFrame for_dog = three.frame(30, three.numbered("x"));
  for_dog.target = "dog";
  three.put(*three.ant, "cloud",
            make_message(MessageType::information, "ant", "cloud", Relayed{three.signed_by_ant(for_dog)}));
  CHECK(three.cloud.count("dropped.unknown_target") == 1);
  CHECK(three.ant->count("refused.not_permitted") == 1);  // ant knows no dog either
  CHECK(three.cloud.count("relayed.sent") > 0);

  // What cannot leave is told its signer, if that is there.
  const auto stuck = [&](TestNode& node, const SignedRecord& record) {
    Effects effects;
    node.core->forwarding().on_own_unsent(make_message(MessageType::information, node.id, "bee", Relayed{record}),
                                          Errc::queue_full, effects);
    return effects.list.size();
  };
  SignedRecord nobodys = three.signed_by_ant(for_dog);
  nobodys.signer = "nobody";
  CHECK(stuck(three.cloud, nobodys) == 0);
  CHECK(stuck(*three.ant, three.signed_by_ant(for_dog)) == 0);
  CHECK(stuck(three.cloud, three.signed_by_ant(for_dog)) == 1);
  three.fleet.stop("ant");
  Effects ended;
  three.cloud.core->links().on_ended(three.cloud.link_to("ant"), LinkEnd::disconnected, three.fleet.now, ended);
  three.fleet.carry_out(three.cloud, ended);
  CHECK(stuck(three.cloud, nobodys) == 0);
}

TEST_CASE(
    "what leaves by a relay has the time that its sender gave it, by the sender's own clock while that is right") {
  TestFleet fleet;
  fleet.cut("ant", "bee");
  fleet.cut("bee", "ant");
  fleet.start("cloud", {.beacon = false, .relay = true, .clock_off = std::chrono::hours(1)});
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"cloud"}});
  fleet.start("bee", {.beacon = false, .seeds = {"cloud"}});
  fleet.run(Seconds(3));
  Message message;
  message.type = MessageType::information;
  message.subtype = "numbered";
  message.source = "ant";
  message.target = "bee";
  message.remaining_ms = 700;
  const auto out = ant.core->relays().wrap(1, "bee", header_of(message), encode_frame(message), fleet.now);
  REQUIRE(out.ok());
  const auto inner = decode<RelayedFrame>(decode<Relayed>(out->message.data)->record.payload.bytes);
  CHECK(inner->expires == fleet.now.utc.ns + 700'000'000);
  CHECK(out->message.remaining_ms == 700);
}

TEST_CASE(
    "by a relay goes a message of 511 kB, and 256 that wait to hear whether they came; one that does not wait goes") {
  Triangle three;
  const std::size_t most = (1U << 19U) - 1024 - kRelayBoxOverhead;
  const auto out = [&](const Message& message) {
    const auto relaying =
        three.ant->core->relays().wrap(1, "bee", header_of(message), encode_frame(message), three.fleet.now);
    return relaying ? Errc::ok : relaying.error().code;
  };
  std::string text(most, 'x');
  while (encode_frame(three.numbered(text)).size() > most) text.pop_back();
  REQUIRE(encode_frame(three.numbered(text)).size() == most);
  CHECK(out(three.numbered(text)) == Errc::ok);
  CHECK(out(three.numbered(text + "x")) == Errc::too_large);
  for (std::size_t i = 0; i < RelayRoad::kMaxUnconfirmed - 1; ++i) {
    REQUIRE(out(three.command(*three.ant)) == Errc::ok);
  }
  CHECK(out(three.command(*three.ant)) == Errc::queue_full);
  Message typed = three.numbered("x");
  typed.subtype = RobotFault::kSubtype;
  CHECK(out(typed) == Errc::ok);
  CHECK(three.ant->core->relays()
            .wrap(1, "nobody", header_of(typed), encode_frame(typed), three.fleet.now)
            .error()
            .code == Errc::peer_unreachable);
}

TEST_CASE("a relay speaks of what it carries, and of nothing else") {
  TwoRelays two;
  const std::uint64_t count = two.lost();
  two.refuse(two.other, "bee", count, Errc::peer_unreachable);
  CHECK(two.ant->count("refused.not_permitted") == 1);
  CHECK(Triangle::nacks(*two.ant).empty());
  two.refuse(two.first, "nobody", count, Errc::peer_unreachable);
  CHECK(two.ant->count("refused.not_permitted") == 2);
  two.refuse(two.first, "bee", count + 1000, Errc::peer_unreachable);  // is not waited for
  CHECK(two.ant->count("refused.not_permitted") == 2);
  CHECK(Triangle::nacks(*two.ant).empty());
  CHECK(two.via() == two.first);
  two.refuse(two.first, "bee", count, Errc::queue_full);
  CHECK(Triangle::nacks(*two.ant) == std::vector<std::string>{"queue_full"});
  CHECK(two.via() == two.first);
  two.refuse(two.first, "bee", two.lost(), Errc::unknown_target);
  CHECK(Triangle::nacks(*two.ant) == std::vector<std::string>{"queue_full", "peer_unreachable"});
  CHECK(two.via() == two.other);
  two.refuse(two.other, "bee", two.lost(), Errc::unknown_target);
  CHECK(two.via() == two.first);  // in turn

  Triangle three;
  const LinkId link = three.cloud.link_to("bee");
  three.fleet.arrive(three.cloud, link, three.cloud.core->table().link(link)->heard + 1,
                     make_message(MessageType::information, "bee", "cloud", RelayRefused{"ant", 1, "queue_full"}));
  CHECK(three.cloud.count("refused.not_permitted") == 1);  // bee is no relay
}

TEST_CASE("when the last relay goes, who waits to hear whether its command came is told at once") {
  Triangle three;
  three.fleet.withhold = [](const std::string& from, const Message& message) {
    return from == "cloud" && message.subtype == Relayed::kSubtype;
  };
  three.put(*three.ant, "cloud", three.wrap(three.command(*three.ant)).message);
  three.fleet.stop("cloud");
  three.fleet.run(2 * kStep);
  Effects effects;
  if (three.ant->link_to("cloud") != 0)
    three.ant->core->links().on_ended(three.ant->link_to("cloud"), LinkEnd::disconnected, three.fleet.now, effects);
  three.fleet.carry_out(*three.ant, effects);
  CHECK(three.nacks(*three.ant) == std::vector<std::string>{"not_confirmed"});
  CHECK(three.ant->count("relayed.unconfirmed") == 1);
  CHECK(std::count_if(three.ant->log.begin(), three.ant->log.end(),
                      [](const std::string& line) { return line.starts_with("route_lost bee"); }) == 1);
}

TEST_CASE("what a node says to every node is taken by a relay too; one whose time or certificate is over is not") {
  Triangle three;
  Message all = three.numbered("to all");
  all.target = "*";
  three.hand_to_bee(three.signed_by_ant(three.frame(40, all)));
  CHECK(three.delivered() == 1);

  const auto hand = [&](const RelayedFrame& frame) {
    const LinkId link = three.bee->link_to("cloud");
    three.fleet.arrive(*three.bee, link, three.bee->core->table().link(link)->heard + 1,
                       make_message(MessageType::information, "cloud", "bee", Relayed{three.signed_by_ant(frame)}));
  };
  RelayedFrame last = three.frame(41, three.numbered("x"));
  last.expires = three.fleet.now.utc.ns;
  hand(last);
  CHECK(three.bee->count("refused.relayed_late") == 1);
  last.expires = three.fleet.now.utc.ns + 1;
  hand(last);
  CHECK(three.delivered() == 2);
  Message spent = three.numbered("x");
  spent.remaining_ms = 0;
  hand(three.frame(42, spent));
  CHECK(three.bee->count("dropped.expired") == 1);

  three.fleet.now.utc = {three.ant->keys.certificate.not_after - 1};
  hand(three.frame(43, three.numbered("x")));
  CHECK(three.delivered() == 3);
  three.fleet.now.utc = {three.ant->keys.certificate.not_after};
  hand(three.frame(44, three.numbered("x")));
  CHECK(three.bee->count("refused.relayed_cert_expired") == 1);
  CHECK(three.delivered() == 3);
}

TEST_CASE("what one relay brings of one node is checked so often in a second and no more") {
  Triangle three;
  SignedRecord forged = three.signed_by_ant(three.frame(50, three.numbered("x")));
  forged.payload.bytes.back() ^= 1;
  const LinkId link = three.bee->link_to("cloud");
  Effects effects;
  for (std::uint32_t i = 0; i < kRelayedChecked + 50; ++i) {
    three.bee->core->inbox().on_message(link, three.cloud.keys.link.public_key,
                                        make_message(MessageType::information, "cloud", "bee", Relayed{forged}), 1,
                                        three.fleet.now, effects);
  }
  three.fleet.carry_out(*three.bee, effects);
  CHECK(three.bee->count("refused.relayed_too_many") >= 50);
  CHECK(three.bee->count("refused.relayed_too_many") < 60);
  CHECK(three.bee->count("refused.relayed_bad_signature") > kRelayedChecked - 10);
}

TEST_CASE("by a relay a router is asked for its tables, hears who listens, and says when nobody takes a message") {
  Triangle three;
  Effects effects;
  three.bee->core->bus().on_hello(3, {"resilience", {}, 5, 100, "1", {"robot_fault"}}, "resilience", three.fleet.now,
                                  effects);
  three.fleet.carry_out(*three.bee, effects);
  three.put(*three.ant, "cloud",
            three.wrap(make_message(MessageType::information, "ant", "bee", RobotFault{})).message);
  three.fleet.run(milliseconds(100));
  CHECK(three.bee->told("robot_fault") == 1);
  CHECK(three.bee->count("dropped.no_service") == 0);  // somebody heard it

  const auto ask = [&](const std::string& word, const Bytes& data, MessageType type) {
    Message question = three.command(*three.ant);
    question.type = type;
    question.subtype = word;
    question.data = data;
    const Routing way = three.ant->core->routing().from_bus(1, header_of(question));
    REQUIRE(way.to == Routing::To::relay);
    three.put(*three.ant, "cloud", three.wrap(question).message);
    three.fleet.run(milliseconds(200));
  };
  ask(std::string(RouteListRequest::kSubtype), encode(RouteListRequest{}), MessageType::request);
  CHECK(three.ant->told(RouteTable::kSubtype) == 1);
  ask(std::string(EchoRequest::kSubtype), encode(EchoRequest{{"ping"}}), MessageType::request);
  CHECK(three.ant->told(Echo::kSubtype) == 1);
  ask("unknown_thing", "x", MessageType::command);
  CHECK(three.bee->count("dropped.no_service") == 1);
  CHECK(Triangle::nacks(*three.ant) == std::vector<std::string>{"no_service"});
}

TEST_CASE("of a profile that changes often one is told in a second by a relay, the newest") {
  Triangle three;
  Effects said;
  three.ant->core->bus().on_hello(2, {"mode-adapter", {}, 5, 100, "1"}, "mode-adapter", three.fleet.now, said);
  three.fleet.carry_out(*three.ant, said);
  std::size_t sent = 0;
  const auto tell = [&](const std::string& model) {
    NodeProfile profile;
    profile.model = model;
    Effects effects;
    three.ant->core->forwarding().on_bus_message(2, make_message(MessageType::information, "ant", "ant", profile),
                                                 three.fleet.now, effects);
    three.fleet.carry_out(*three.ant, effects);
    three.fleet.run(5 * kStep);
  };
  tell("a");
  three.fleet.run(Seconds(2));
  REQUIRE(three.bee->peer("ant")->profile.model == "a");
  tell("b");
  CHECK(three.bee->peer("ant")->profile.model == "b");
  for (const char* model : {"c", "d", "e"}) tell(model);
  CHECK(three.bee->peer("ant")->profile.model == "b");
  const std::uint64_t before = three.bee->count("relayed.received");
  three.fleet.run(Seconds(1));
  CHECK(three.bee->peer("ant")->profile.model == "e");
  sent = three.bee->count("relayed.received") - before;
  CHECK(sent == 1);
}

TEST_CASE("a word by a relay that one service takes and another hears comes to both") {
  Triangle three;
  Effects effects;
  three.bee->core->bus().on_hello(3, {"resilience", {}, 5, 100, "1", {"robot_fault"}}, "resilience", three.fleet.now,
                                  effects);
  three.bee->core->bus().on_hello(4, {"cloud-gateway", {"robot_fault"}, 6, 100, "1"}, "cloud-gateway", three.fleet.now,
                                  effects);
  three.fleet.carry_out(*three.bee, effects);
  three.put(*three.ant, "cloud",
            three.wrap(make_message(MessageType::information, "ant", "bee", RobotFault{})).message);
  three.fleet.run(milliseconds(100));
  std::string heard;
  for (const BusSend& send : three.bee->bus) {
    if (send.message.subtype == RobotFault::kSubtype) heard += std::to_string(send.to) + " ";
  }
  CHECK(heard == "3 4 ");
}
