// Messages by a relay: accepted, refused, lost, answered. Time is injected, nothing sleeps.
#include <doctest/doctest.h>

#include "services/router/test/test_relays.hpp"

using namespace trb;
using namespace trb::router;

namespace {

/// The relay brings bee the same again and again, within a moment.
void bring(Triangle& three, const SignedRecord& record, std::uint32_t times) {
  const LinkId link = three.bee->link_to("cloud");
  Effects effects;
  for (std::uint32_t i = 0; i < times; ++i) {
    three.bee->core->inbox().on_message(link, three.cloud.keys.link.public_key,
                                        make_message(MessageType::information, "cloud", "bee", Relayed{record}), 1,
                                        three.fleet.now, effects);
  }
  three.fleet.carry_out(*three.bee, effects);
}

}  // namespace

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
  const auto check_refused = [&](const SignedRecord& record, const std::string& by) {
    CAPTURE(by);
    const std::uint64_t before = three.bee->count("refused.relayed_" + by);
    three.hand_to_bee(record);
    CHECK(three.bee->count("refused.relayed_" + by) == before + 1);
  };
  const auto changed = [&](std::uint64_t count, const std::function<void(RelayedFrame&)>& change) {
    RelayedFrame frame = three.frame(count, three.numbered("x"));
    change(frame);
    return three.signed_by_ant(frame);
  };
  const auto of_message = [&](std::uint64_t count, const std::function<void(Message&)>& change) {
    Message message = three.numbered("x");
    change(message);
    return three.signed_by_ant(three.frame(count, message));
  };
  const auto signed_as_ant = [&](std::string_view kind, const SigningKey& key) {
    return sign(kind, "ant", three.fleet.authority.fleet.id(), encode(three.frame(6, three.numbered("x"))), key);
  };
  const auto now = three.fleet.now.utc.ns;
  const SignedRecord good = three.signed_by_ant(three.frame(5, three.numbered("x")));
  three.hand_to_bee(good);
  CHECK(three.delivered() == 1);

  check_refused(good, "replayed");
  check_refused(changed(6, [](RelayedFrame& is) { is.source_boot = 2; }), "replayed");
  SignedRecord forged = three.signed_by_ant(three.frame(6, three.numbered("x")));
  forged.payload.bytes.back() ^= 1;
  check_refused(forged, "bad_signature");
  check_refused(signed_as_ant(kSignedRelayed, three.cloud.keys.identity), "bad_signature");
  check_refused(signed_as_ant(kSignedResult, three.ant->keys.identity), "bad_signature");
  check_refused(changed(6, [&](RelayedFrame& is) { is.expires = now - 1; }), "late");
  check_refused(changed(6, [](RelayedFrame& is) { is.target_boot = 2; }), "other_boot");
  check_refused(of_message(7, [](Message& is) { is.source = "cloud"; }), "source_mismatch");
  check_refused(of_message(8, [](Message& is) { is.target = "cat"; }), "wrong_target");
  const auto boxed_with = [&](const Bytes& peer) {
    return changed(
        9, [&](RelayedFrame& is) { is.box.bytes = lock_relayed(relay_key(three.ant->keys.link, peer), "nothing"); });
  };
  check_refused(boxed_with(three.bee->keys.link.public_key), "malformed");
  check_refused(boxed_with(three.cloud.keys.link.public_key), "wrong_key");
  SignedRecord unknown = three.signed_by_ant(three.frame(10, three.numbered("x")));
  unknown.signer = "nobody";
  check_refused(unknown, "unknown_signer");
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
  Message told = make_message(MessageType::information, "bee", "cloud", ReachablePeerList{});
  three.put(*three.bee, "cloud", told);
  CHECK(three.cloud.count("refused.not_permitted") == 1);
}

TEST_CASE("the same name on another computer counts anew; the old computer's words stay refused") {
  Triangle three;
  three.hand_to_bee(three.signed_by_ant(three.frame(500, three.numbered("old"))));
  CHECK(three.delivered() == 1);
  const SignedRecord kept = three.signed_by_ant(three.frame(501, three.numbered("kept")));
  const TestKeys anew = three.fleet.authority.sign_node("ant", Role::robot, 2);
  const ReachablePeerList told{{anew.record}, {}};
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

  // A message that cannot be passed on: its signer is notified, if it is there.
  const auto stuck = [&](TestNode& node, const SignedRecord& record) {
    Effects effects;
    node.core->forwarding().on_own_unsent(make_message(MessageType::information, node.id, "bee", Relayed{record}),
                                          Errc::queue_full, three.fleet.now, effects);
    return effects.list.size();
  };
  SignedRecord nobodys = three.signed_by_ant(for_dog);
  nobodys.signer = "nobody";
  CHECK(stuck(three.cloud, nobodys) == 0);
  CHECK(stuck(*three.ant, three.signed_by_ant(for_dog)) == 0);
  CHECK(stuck(three.cloud, three.signed_by_ant(for_dog)) == 1);
  three.fleet.stop("ant");
  Effects ended;
  three.cloud.core->links().on_ended(three.cloud.link_to("ant"), LinkEndReason::disconnected, three.fleet.now, ended);
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
  const Message message{.type = MessageType::information,
                        .remaining_ms = 700,
                        .subtype = "numbered",
                        .source = "ant",
                        .target = "bee",
                        .data = {}};
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
  for (std::size_t i = 0; i < RelayConnection::kMaxUnconfirmed - 1; ++i) {
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
  bring(three, three.signed_by_ant(three.frame(50, three.numbered("x"))), kRelayedChecked + 50);
  CHECK(three.bee->count("refused.relayed_too_many") >= 50);
  CHECK(three.bee->count("refused.relayed_too_many") < 60);
  CHECK(three.bee->count("refused.relayed_replayed") > kRelayedChecked - 10);
}

TEST_CASE("a relay that forges is checked so often in a second, whomever it names, and takes no source's share") {
  Triangle three;
  const TestKeys cat = three.fleet.authority.sign_node("cat", Role::robot, 1);
  three.put(three.cloud, "bee",
            make_message(MessageType::information, "cloud", "bee", ReachablePeerList{{cat.record}, {}}));
  SignedRecord forged = three.signed_by_ant(three.frame(50, three.numbered("x")));
  forged.payload.bytes.back() ^= 1;
  bring(three, forged, kRelayedForged - 20);
  forged.signer = "cat";
  bring(three, forged, 2000);
  CHECK(three.bee->count("refused.relayed_bad_signature") == kRelayedForged);
  CHECK(three.bee->count("refused.relayed_too_many_forged") == 1980);
  CHECK(three.bee->count("refused.relayed_too_many") == 0);
  // In the next second it is listened to again.
  three.fleet.run(std::chrono::seconds(1));
  three.hand_to_bee(three.signed_by_ant(three.frame(51, three.numbered("y"))));
  CHECK(three.delivered() == 1);
}
