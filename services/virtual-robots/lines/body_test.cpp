#include "services/virtual-robots/lines/body.hpp"

#include <doctest/doctest.h>

#include "services/virtual-robots/lines/reports.hpp"

using namespace trb::virtual_robots::lines;

namespace {

using Lines = std::vector<std::string>;

/** A body, its clock, and its messages: `SUBTYPE DATA`, for an answer with `-> TARGET` behind it. */
struct Fixture {
  explicit Fixture(BodySettings settings = {}) : body(std::move(settings)) {}

  void command(const std::string& skill, const std::string& data = "") {
    body.take({"command", skill, "ui", data}, now);
  }
  std::string ask(const std::string& what) {
    body.take({"request", what, "ui", ""}, now);
    return said().back();
  }
  void wait(double seconds) { body.advance(now += seconds); }

  Lines said() {
    Lines out;
    for (const BodyEvent& event : body.take_events()) {
      const auto message = message_of(event, Vocabulary{});
      if (!message) continue;
      out.push_back(message->subtype + " " + message->data + (message->peer.empty() ? "" : " -> " + message->peer));
    }
    return out;
  }

  Body body;
  double now = 100;
};

}  // namespace

TEST_CASE("body: go_to drives at one metre a second and says done") {
  Fixture fixture({{}, {1, 0, 0}, 87, {}});
  fixture.command("go_to", "3 0 1.5");
  CHECK(fixture.body.next_deadline() == doctest::Approx(102));
  fixture.wait(0.5);
  CHECK(fixture.ask("position") == "position 1.500 0.000 0.375 -> ui");
  fixture.wait(1.5);
  CHECK(fixture.said() == Lines{"done go_to"});
  CHECK(fixture.ask("position") == "position 3.000 0.000 1.500 -> ui");
  CHECK_FALSE(fixture.body.next_deadline());
}

TEST_CASE("body: the shortest drive, a given duration, and the short way round") {
  Fixture near;
  near.command("go_to", "0.01 0 0");
  CHECK(near.body.next_deadline() == doctest::Approx(100.2));
  Fixture given({{{"go_to", 4.0}}, {0, 0, 3.0}, 100, {}});
  given.command("go_to", "1 0 -3.0");
  CHECK(given.body.next_deadline() == doctest::Approx(104));
  given.wait(2);
  CHECK(given.body.pose(given.now).yaw == doctest::Approx(3.14159).epsilon(0.001));
}

TEST_CASE("body: a skill takes its time; a second command meanwhile is refused") {
  Fixture fixture({{{"pick", 2.0}}, {}, 100, {}});
  fixture.command("pick");
  fixture.command("go_to", "1 1 1");
  CHECK(fixture.said() == Lines{"failed go_to busy"});
  fixture.command("sing");
  CHECK(fixture.said().empty());
  fixture.wait(2);
  CHECK(fixture.said() == Lines{"done pick"});
  CHECK(fixture.ask("position") == "position 0.000 0.000 0.000 -> ui");
}

TEST_CASE("body: stop abandons the skill where it is, until release") {
  Fixture fixture;
  fixture.command("go_to", "4 0 0");
  fixture.wait(1);
  fixture.body.stop(fixture.now);
  CHECK(fixture.said() == Lines{"failed go_to stopped"});
  fixture.body.stop(fixture.now);
  CHECK(fixture.said().empty());
  fixture.wait(10);
  CHECK(fixture.ask("position") == "position 1.000 0.000 0.000 -> ui");
  fixture.command("go_to", "4 0 0");
  CHECK(fixture.said() == Lines{"failed go_to stopped"});
  fixture.body.release();
  fixture.command("go_to", "2 0 0");
  fixture.wait(1);
  CHECK(fixture.said() == Lines{"done go_to"});
}

TEST_CASE("body: bad data and injected failures") {
  Fixture fixture({{{"pick", 1.0}, {"drop", 1.0}}, {}, 100, {{"pick", {2}}, {"drop", {}}}});
  for (const char* data : {"", "1 2", "1 2 x", "1 2 3 4", "inf 0 0", "1  2 3"}) fixture.command("go_to", data);
  CHECK(fixture.said() == Lines(6, "failed go_to bad data"));
  fixture.command("pick");
  fixture.wait(1);
  fixture.command("pick");
  fixture.command("drop");
  fixture.command("pick");
  fixture.wait(1);
  fixture.command("drop");
  CHECK(fixture.said() == Lines{"done pick", "failed pick injected failure", "failed drop injected failure",
                                "done pick", "failed drop injected failure"});
}

TEST_CASE("body: the battery drains with work only") {
  Fixture fixture({{{"lift", 90.0}}, {}, 87, {}});
  fixture.wait(1000);
  CHECK(fixture.ask("battery") == "battery 87 -> ui");
  fixture.command("lift");
  fixture.wait(60);
  CHECK(fixture.ask("battery") == "battery 86 -> ui");
  fixture.wait(1000);
  fixture.said();
  CHECK(fixture.ask("battery") == "battery 85.5 -> ui");
  CHECK(fixture.ask("weather") == "weather unknown -> ui");
}

TEST_CASE("reports: numbers for the numeric encoding") {
  Vocabulary vocabulary;
  vocabulary.numeric = true;
  vocabulary.codes.add("subtype:pick=7");
  CHECK(message_of(Done{"pick"}, vocabulary)->data == "7");
  CHECK(message_of(Failed{"pick", Reason::stopped}, vocabulary)->data == "7 2");
  CHECK(message_of(Failed{"lift", Reason::injected}, vocabulary)->data == "0 3");
  CHECK(parse_fault("pick CRITICAL it broke", vocabulary)->data == "7 3");
  CHECK(fault_over("pick", vocabulary).data == "7 0");
}

TEST_CASE("reports: orders from stdin") {
  const Vocabulary text;
  CHECK(parse_say("request position ur3 a b\\nc") == Message{"request", "position", "ur3", "a b\nc"});
  CHECK(parse_say("information note -") == Message{"information", "note", "", ""});
  CHECK_FALSE(parse_say("information note"));
  CHECK(parse_fault("drive URGENT a wheel slips", text) ==
        Message{"information", "fault", "", "drive URGENT a wheel slips"});
  CHECK_FALSE(parse_fault("drive BAD a wheel slips", text));
  CHECK(fault_over("drive", text) == Message{"information", "fault", "", "drive OVER"});
}

TEST_CASE("codes: definitions") {
  Codes codes;
  CHECK(codes.add("subtype:move=7"));
  CHECK(codes.add("id:ur3=-2"));
  for (const char* bad : {"", "move=7", "subtype:=7", "subtype:move", "subtype:move=x", "colour:red=1"}) {
    CHECK_FALSE(codes.add(bad));
  }
  CHECK(codes.subtype_number("move") == "7");
  CHECK(codes.subtype_number("12") == "12");
  CHECK_FALSE(codes.subtype_number("lift"));
  CHECK(codes.id_word("-2") == "ur3");
  CHECK(codes.id_word("3") == "3");
}
