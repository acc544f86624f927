// How links and dials end, and what is reported of it. Time is injected, nothing sleeps.
#include "services/router/test/test_linked.hpp"

using namespace trb;
using namespace trb::router;

TEST_CASE("a certificate that ends takes its link with it") {
  TestFleet fleet;
  fleet.keys("bee").certificate.not_after = kStartUtc + 5'000'000'000;
  TestKeys& keys = fleet.keys("bee");
  keys.record = sign(kSignedCertificate, "", fleet.authority.fleet.id(), encode(keys.certificate), fleet.authority.key);
  fleet.start_two(Seconds(1));
  check_linked(fleet, "ant", "bee");
  fleet.run(Seconds(8));
  CHECK(fleet.at("ant").link_to("bee") == 0);
}

TEST_CASE("a frame that is none ends its link under a name of its own, not as a gap in the sequence") {
  TestFleet fleet;
  fleet.start_two(milliseconds(500));
  const LinkId link = fleet.at("bee").link_to("ant");
  Effects effects;
  fleet.at("bee").core->links().on_bad_frame(link, fail(Errc::malformed, "header: no array"), fleet.now, effects);
  fleet.carry_out(fleet.at("bee"), effects);
  CHECK(fleet.at("bee").link_to("ant") == 0);
  CHECK(fleet.at("bee").count("refused.malformed") == 1);
  CHECK(fleet.at("bee").count("refused.sequence") == 0);
  fleet.run(Seconds(5));
  check_linked(fleet, "ant", "bee");
}

TEST_CASE("the end of one dial says nothing of another: each seed is dialled again after its own") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee", "cat"}});
  fleet.start("cat", {.beacon = false});
  fleet.cut("ant", "cat");  // it does not answer; there is no node at bee's address
  const auto dials = [&](const std::string& to) {
    return std::count_if(ant.dials.begin(), ant.dials.end(),
                         [&](const Dial& dial) { return dial.address == fleet.address(to); });
  };
  fleet.run(milliseconds(2150));
  CHECK(dials("bee") == 4);  // at once, then 0.2, 0.4 and 0.8 s later
  CHECK(dials("cat") == 1);
  fleet.run(milliseconds(150));
  CHECK(dials("cat") == 2);  // two seconds for its Hello, and 0.2 s
}

TEST_CASE("who is reached by a relay is dialled more seldom than who is not reached at all") {
  for (const bool relay : {true, false}) {
    CAPTURE(relay);
    TestFleet fleet;
    fleet.start("cloud", {.beacon = false, .relay = relay});
    TestNode& ant = fleet.start("ant", {.seeds = {"cloud"}});
    fleet.start("bee", {.seeds = {"cloud"}});
    fleet.run(Seconds(3));
    check_linked(fleet, "ant", "bee");
    fleet.cut("ant", "bee");
    fleet.cut("bee", "ant");
    fleet.run(Seconds(40));
    CHECK(ant.link_to("bee") == 0);
    CHECK(ant.relay_route("bee").open == relay);
    const std::size_t before = ant.dials.size();
    fleet.run(Seconds(60));
    // Each dial waits two seconds for its Hello, and then four seconds or two.
    CHECK(ant.dials.size() - before == (relay ? 10 : 15));
  }
}

TEST_CASE("a dial that is answered by anything but a Hello has failed; only a Goodbye that can be read tells why") {
  const auto answered = [](const std::string& subtype, const Bytes& data) {
    TestFleet fleet;
    TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
    fleet.start("bee", {.beacon = false});
    fleet.withhold = [](const std::string& from, const Message&) { return from == "bee"; };
    fleet.run(2 * kStep);
    Message word = make_message(MessageType::information, "bee", "", Goodbye{});
    word.subtype = subtype;
    word.data = data;
    fleet.arrive(ant, ant.dials.back().link, 1, word);
    CHECK(ant.count("dial.refused") == 1);
    CHECK(ant.core->table().link(ant.dials.back().link) == nullptr);
    return ant.log.back();
  };
  CHECK(answered("goodbye", encode(Goodbye{"other fleet"})) == "dial_ended unproven: refused: other fleet");
  CHECK(answered("goodbye", "noise") == "dial_ended unproven: answered without Hello");
  CHECK(answered("keep_alive", encode(Goodbye{"other fleet"})) == "dial_ended unproven: answered without Hello");
}

namespace {

bool says(const Effects& effects, std::string_view subtype) {
  return std::any_of(effects.list.begin(), effects.list.end(), [&](const Effect& effect) {
    const auto* send = std::get_if<LinkSend>(&effect);
    return send != nullptr && send->message.subtype == subtype;
  });
}

template <class T>
bool contains_a(const Effects& effects) {
  return std::any_of(effects.list.begin(), effects.list.end(),
                     [](const Effect& effect) { return std::holds_alternative<T>(effect); });
}

}  // namespace

TEST_CASE("a link that is closed here ends with a seal and a Goodbye; one that broke, or was never up, with neither") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee", "cat", "dog"}});
  for (const char* id : {"bee", "cat", "dog"}) fleet.start(id, {.beacon = false});
  fleet.cut("ant", "dog");
  fleet.run(Seconds(1));
  const LinkId dial = std::find_if(ant.dials.begin(), ant.dials.end(), [&](const Dial& one) {
                        return one.address == fleet.address("dog");
                      })->link;
  Effects closed;
  ant.core->links().on_bad_frame(ant.link_to("bee"), fail(Errc::malformed, "header: no array"), fleet.now, closed);
  CHECK(says(closed, Goodbye::kSubtype));
  CHECK(contains_a<SealDue>(closed));
  CHECK_FALSE(contains_a<ReturnHeld>(closed));  // its messages were delivered at once
  Effects broken;
  ant.core->links().on_ended(ant.link_to("cat"), LinkEndReason::disconnected, fleet.now, broken);
  CHECK(contains_a<CloseLink>(broken));
  CHECK_FALSE(says(broken, Goodbye::kSubtype));
  CHECK_FALSE(contains_a<SealDue>(broken));
  Effects never;
  ant.core->links().on_bad_frame(dial, fail(Errc::malformed, "header: no array"), fleet.now, never);
  CHECK(contains_a<CloseLink>(never));
  CHECK_FALSE(says(never, Goodbye::kSubtype));
  CHECK_FALSE(contains_a<SealDue>(never));
}

TEST_CASE("how a dial ended is counted, unless nobody was there or the connection broke, as happens every day") {
  for (const auto how :
       {LinkEndReason::failed, LinkEndReason::disconnected, LinkEndReason::refused_key, LinkEndReason::no_curve}) {
    TestFleet fleet;
    TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
    fleet.start("bee", {.beacon = false});
    fleet.cut("ant", "bee");
    fleet.run(kStep);
    Effects effects;
    ant.core->links().on_ended(ant.dials.back().link, how, fleet.now, effects);
    const bool counted = how == LinkEndReason::refused_key || how == LinkEndReason::no_curve;
    CHECK(effects.counts ==
          (counted ? std::vector<std::string>{"dial." + std::string(name_of(how))} : std::vector<std::string>{}));
  }
}

TEST_CASE("a keep-alive is confirmed by one that has heard it, and by none that has heard only what was before it") {
  for (const bool heard : {true, false}) {
    CAPTURE(heard);
    TestFleet fleet;
    TestNode& ant = fleet.start("ant", {.beacon = false});
    const TestKeys bee = fleet.keys("bee");
    const Hello hello{bee.record, 3, "10.0.0.2:45000", "1", kStartUtc, true, {}, 0, "behind", false, ""};
    const auto say = [&](const auto& body) {
      Effects effects;
      ant.core->inbox().on_message(9, bee.link.public_key, make_message(MessageType::information, "bee", "ant", body),
                                   1, fleet.now, effects);
      fleet.carry_out(ant, effects);
    };
    say(hello);
    fleet.run(milliseconds(2500));
    const auto& sent = ant.core->table().link(9)->unconfirmed;
    REQUIRE(sent.size() == 1);
    say(KeepAlive{sent.front() - (heard ? 0 : 1)});
    CHECK(ant.core->table().link(9)->unconfirmed.empty() == heard);
    CHECK((ant.core->table().link(9)->confirmed == fleet.now.mono) == heard);
  }
}
