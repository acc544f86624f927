// Messages by a relay that did not arrive: who is notified, and which relay is taken next. Time is injected.
#include "services/router/test/test_relays.hpp"

using namespace trb;
using namespace trb::router;

TEST_CASE("a target that the relay has lost: who sent it is told at once; a message over 511 kB never leaves") {
  Triangle three;
  const Relaying relaying = three.wrap(three.command(*three.ant));
  three.fleet.stop("bee");
  three.fleet.run(milliseconds(20));
  Effects effects;
  three.cloud.core->links().on_ended(three.cloud.link_to("bee"), LinkEndReason::disconnected, three.fleet.now, effects);
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
  for (const auto& one : times) CHECK_MESSAGE(one.second == 1, one.first);
  CHECK(three.cloud.delivered.empty());
  CHECK(three.cloud.told("numbered") == 0);
  CHECK(three.ant->told("numbered") == 0);
  CHECK(three.bee->count("refused.relayed_replayed") == 0);
}

TEST_CASE("a relay passes a message on as its sender's, who has a share of the link; its own are its own") {
  Triangle three;
  const Relaying relaying = three.wrap(three.command(*three.ant));
  Effects effects;
  three.cloud.core->inbox().on_message(three.cloud.link_to("ant"), three.ant->keys.link.public_key, relaying.message,
                                       99, three.fleet.now, effects);
  REQUIRE(effects.list.size() == 1);
  CHECK(std::get<LinkSend>(effects.list[0]).link == three.cloud.link_to("bee"));
  CHECK(std::get<LinkSend>(effects.list[0]).peer == "ant");
  Effects refused;
  three.cloud.core->forwarding().on_own_unsent(relaying.message, Errc::queue_full, three.fleet.now, refused);
  REQUIRE(refused.list.size() == 1);
  CHECK(std::get<LinkSend>(refused.list[0]).peer.empty());
}

TEST_CASE("what finds the relay's queue full, or this node's own, is told to who sent it, once") {
  Triangle three;
  const Relaying relaying = three.wrap(three.command(*three.ant));
  Effects effects;
  three.cloud.core->forwarding().on_own_unsent(relaying.message, Errc::queue_full, three.fleet.now, effects);
  REQUIRE(effects.list.size() == 1);
  CHECK(std::get<LinkSend>(effects.list[0]).link == three.cloud.link_to("ant"));
  three.fleet.carry_out(three.cloud, effects);
  three.fleet.run(Seconds(4));
  CHECK(three.nacks(*three.ant) == std::vector<std::string>{"queue_full"});

  const Relaying own = three.wrap(three.command(*three.ant));
  Effects stuck;
  three.ant->core->forwarding().on_own_unsent(own.message, Errc::queue_full, three.fleet.now, stuck);
  three.fleet.carry_out(*three.ant, stuck);
  three.fleet.run(Seconds(4));
  CHECK(three.nacks(*three.ant) == std::vector<std::string>{"queue_full", "queue_full"});

  Message nonsense = relaying.message;
  nonsense.data = "nothing";
  Effects none;
  three.cloud.core->forwarding().on_own_unsent(nonsense, Errc::queue_full, three.fleet.now, none);
  CHECK(none.list.empty());
}

TEST_CASE("a relay that loses a command in silence: who sent it is told that nobody confirms it") {
  Triangle three;
  bool lose = false;
  three.fleet.withhold = [&](const std::string& from, const Message& message) {
    return lose && from == "cloud" && message.subtype == Relayed::kSubtype;
  };
  three.put(*three.ant, "cloud", three.wrap(three.command(*three.ant)).message);
  three.fleet.run(Seconds(4));
  CHECK(three.nacks(*three.ant).empty());  // it arrived, and that was confirmed

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
  TwoRelays two;
  int lose = 1;
  two.fleet.withhold = [&](const std::string& from, const Message& message) {
    if (from != two.first || message.subtype != Relayed::kSubtype) return false;
    return decode<Relayed>(message.data)->record.signer == "ant" && lose-- > 0;
  };
  Triangle::say(two.fleet, *two.ant, 1);
  two.fleet.run(kStep * 3);
  Triangle::say(two.fleet, *two.ant, 2);
  two.fleet.run(milliseconds(400));
  CHECK(two.ant->told(Nack::kSubtype) == 1);
  CHECK(two.via() != two.first);
  Triangle::say(two.fleet, *two.ant, 3);
  two.fleet.run(milliseconds(400));
  CHECK(two.bee->told("numbered") == 2);
  CHECK(two.ant->told(Nack::kSubtype) == 1);
}

TEST_CASE("a relay speaks of what it carries, and of nothing else") {
  TwoRelays two;
  const std::uint64_t count = two.lost();
  two.refuse(two.other, "bee", count, Errc::peer_unreachable);
  CHECK(two.ant->count("refused.not_permitted") == 1);
  CHECK(Triangle::nacks(*two.ant).empty());
  two.refuse(two.first, "nobody", count, Errc::peer_unreachable);
  CHECK(two.ant->count("refused.not_permitted") == 2);
  two.refuse(two.first, "bee", count + 1000, Errc::peer_unreachable);  // not waited for
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
    three.ant->core->links().on_ended(three.ant->link_to("cloud"), LinkEndReason::disconnected, three.fleet.now,
                                      effects);
  three.fleet.carry_out(*three.ant, effects);
  CHECK(three.nacks(*three.ant) == std::vector<std::string>{"not_confirmed"});
  CHECK(three.ant->count("relayed.unconfirmed") == 1);
  CHECK(std::count_if(three.ant->log.begin(), three.ant->log.end(),
                      [](const std::string& line) { return line.starts_with("route_lost bee"); }) == 1);
}
