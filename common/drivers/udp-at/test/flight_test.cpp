// Flying an AR.Drone: take-off, hover, motion, land, stop, emergency, and what the drone does by itself.
#include "common/drivers/udp-at/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

using Calls = std::vector<std::string>;

TEST_CASE("take_off: trimmed on level ground, and over once the drone stands in the air") {
  DroneFixture fixture;
  CHECK(fixture.answer(fixture.execute("take_off")) == "running");
  CHECK(fixture.sent() == Calls{"FTRIM", kRefAir, kHoverCall});
  fixture.live(0.5, kOnGround);
  fixture.live(2, kTakingOff);
  CHECK(fixture.told<Outcome>().empty());
  CHECK(fixture.last("REF") == kRefAir);
  fixture.tell(kHovering);
  const auto outcome = fixture.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::finished);
  CHECK(outcome.duration_s == doctest::Approx(2.5));
}

TEST_CASE("hover: so long, by the node's clock; land: over on the ground") {
  DroneFixture fixture(kHovering);
  fixture.execute("hover", R"({"duration": 4})");
  fixture.live(3.9, kHovering);
  CHECK(fixture.told<Outcome>().empty());
  fixture.live(0.2, kHovering);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
  CHECK(fixture.last("REF") == kRefAir);

  fixture.deliver(MessageType::command, order("land", "", 2), "drone");
  CHECK(fixture.sent() == Calls{kRefGround, kHoverCall});
  fixture.live(2, kLanding);
  CHECK(fixture.told<Outcome>().size() == 2);  // hover's, which was never journaled
  fixture.tell(kOnGround);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("a motion never lasts longer than was said, or than a second") {
  DroneFixture fixture(kHovering);
  CHECK(fixture.answer(fixture.command("move", "[0, -0.8, 0, 0.05, 2]")) == "ack handed_over");
  CHECK(fixture.sent() == Calls{kRefAir, "PCMD,1,0,-1085485875,0,1028443341"});
  fixture.live(1.95, kHovering);
  CHECK(fixture.last("PCMD") == "PCMD,1,0,-1085485875,0,1028443341");
  fixture.live(0.1, kHovering);
  CHECK(fixture.last("PCMD") == kHoverCall);
  fixture.command("nudge", "");
  fixture.live(0.95, kHovering);
  CHECK(fixture.last("PCMD") == "PCMD,1,0,-1085485875,0,0");
  fixture.live(0.1, kHovering);
  CHECK(fixture.last("PCMD") == kHoverCall);
}

TEST_CASE("a motion on the ground is refused: the drone would do nothing and say nothing") {
  DroneFixture fixture(kOnGround);
  const auto id = fixture.command("move", "[0, -0.8, 0, 0, 2]");
  CHECK(fixture.nack_of(id).code == "conflict");
  CHECK(fixture.nack_of(id).what == "the drone is not in the air");
  CHECK(fixture.answer(fixture.command("hover", "3")) == "nack conflict");
  CHECK(fixture.sent().empty());
  CHECK(fixture.answer(fixture.command("land", "")) == "ack handed_over");
}

TEST_CASE("two commands at once: the later one counts, and the skill that it ends is told so") {
  DroneFixture fixture(kHovering);
  fixture.execute("hover", R"({"duration": 30})");
  CHECK(fixture.answer(fixture.command("land", "")) == "nack control_held");
  fixture.flags = kFlagTakeControl;
  CHECK(fixture.answer(fixture.command("land", "")) == "ack handed_over");
  CHECK(fixture.failure() == "'land' took its place");
  CHECK(fixture.last("REF") == kRefGround);
}

TEST_CASE("two skills at once: the second one is refused as busy, nothing is sent for it") {
  DroneFixture fixture(kHovering);
  fixture.execute("hover", R"({"duration": 30})");
  fixture.sent();
  const auto second = fixture.deliver(MessageType::command, order("land", "", 2), "drone");
  CHECK(fixture.answer(second) == "nack busy");
  CHECK(fixture.sent().empty());
}

TEST_CASE("a stop in the air stands, says so once the drone stands, and fences; landing needs a release") {
  DroneFixture fixture(kHovering);
  fixture.command("move", "[0, -0.8, 0, 0, 20]");
  Sky moving = kHovering;
  moving.vx = 900;
  fixture.live(0.5, moving);
  fixture.sent();
  const auto stop = fixture.deliver(MessageType::command, Stop{"a person in the way"});
  CHECK(fixture.sent() == Calls{kRefAir, kHoverCall});
  fixture.live(0.4, moving);
  CHECK(fixture.answer(stop).empty());
  fixture.live(0.125, kHovering);
  CHECK(fixture.answer(stop) == "ack stopped");
  CHECK(fixture.answer(fixture.command("land", "")) == "nack fenced");
  CHECK(fixture.last("REF") == kRefAir);
  CHECK(fixture.answer(fixture.deliver(MessageType::command, Release{})) == "ack released");
  CHECK(fixture.answer(fixture.command("land", "")) == "ack handed_over");
}

TEST_CASE("a stop that the drone does not obey is not confirmed") {
  DroneFixture fixture(kHovering);
  Sky moving = kHovering;
  moving.vx = 900;
  fixture.tell(moving);
  const auto stop = fixture.deliver(MessageType::command, Stop{""});
  fixture.live(2.1, moving);
  CHECK(fixture.nack_of(stop).what.find("did not confirm the stop within 2 s") != std::string::npos);
}

TEST_CASE("a stop while it takes off or lands brings it to the ground; with REF land it always does") {
  DroneFixture fixture(kOnGround);
  fixture.execute("take_off");
  fixture.live(0.5, kTakingOff);
  fixture.deliver(MessageType::command, Stop{""});
  CHECK(fixture.last("REF") == kRefGround);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);

  DroneFixture landing(kHovering);
  landing.command("land", "");
  landing.tell(kLanding);
  landing.deliver(MessageType::command, Stop{""});
  CHECK(landing.last("REF") == kRefGround);

  Settings settings = drone();
  settings.commands.commands["stop"] = "REF land";
  DroneFixture lands(kHovering, settings);
  lands.deliver(MessageType::command, Stop{""});
  CHECK(lands.last("REF") == kRefGround);
}

TEST_CASE("emergency cuts the motors once, recover lifts it once: each ends when the drone says so") {
  DroneFixture fixture(kHovering);
  const auto cut = fixture.command("emergency", "");
  CHECK(fixture.answer(cut).empty());
  CHECK(fixture.last("REF") == kRefToggle);
  Sky fallen = kOnGround;
  fallen.bits = kEmergencyBit;
  fixture.live(0.125, fallen);
  CHECK(fixture.answer(cut) == "ack handed_over");
  fixture.wait(0.03);
  CHECK(fixture.last("REF") == kRefGround);
  CHECK(fixture.faults().at(0).text == "emergency: the motors are cut");
  // Sent twice it must not toggle: the drone stays as it is.
  const auto again = fixture.command("emergency", "");
  fixture.live(0.125, fallen);
  CHECK(fixture.answer(again) == "ack handed_over");

  CHECK(fixture.nack_of(fixture.command("take_off", "")).hint.find("command recover") != std::string::npos);
  const auto recover = fixture.command("recover", "");
  CHECK(fixture.last("REF") == kRefToggle);
  fixture.live(0.125, kOnGround);
  CHECK(fixture.answer(recover) == "ack handed_over");
  fixture.wait(0.03);
  CHECK(fixture.last("REF") == kRefGround);
}

TEST_CASE("an emergency that the drone does not confirm is said, and is not sent for ever") {
  DroneFixture fixture(kHovering);
  const auto cut = fixture.command("emergency", "");
  fixture.live(1.6, kHovering);
  CHECK(fixture.nack_of(cut).what == "the drone did not confirm 'emergency' within 1.5 s");
  fixture.wait(0.03);
  CHECK(fixture.last("REF") == kRefGround);
}

TEST_CASE("an emergency in the middle of a skill: the skill fails, and everybody is told why, once") {
  DroneFixture fixture(kHovering);
  fixture.execute("hover", R"({"duration": 30})");
  Sky fallen = kOnGround;
  fallen.bits = kEmergencyBit | kCutoutBit;
  fixture.live(1, fallen);
  CHECK(fixture.failure() == "the drone's motors were cut (battery 76 %): cutout: a motor was held or stopped");
  const auto faults = fixture.faults();
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].capability == "fly");
  CHECK(faults[0].severity == Severity::critical);
  CHECK(faults[0].text == "emergency: the motors are cut (cutout: a motor was held or stopped)");
  CHECK(fixture.last("REF") == kRefGround);
}

TEST_CASE("a low battery is a fault at its edge, and a drone that comes down by itself is not sent up again") {
  DroneFixture fixture(kHovering);
  fixture.execute("hover", R"({"duration": 30})");
  Sky low = kHovering;
  low.bits = kBatteryLowBit;
  low.battery = 19;
  fixture.live(1, low);
  const auto faults = fixture.faults();
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].severity == Severity::urgent);
  CHECK(faults[0].text == "battery low: 19 %");
  low.control = 8;
  fixture.live(0.25, low);
  CHECK(fixture.one<Outcome>().reason == "the drone came down by itself (battery 19 %): battery low");
  CHECK(fixture.last("REF") == kRefGround);
}

TEST_CASE("a drone that does not take off: said after 3 s, and it is not left to take off later") {
  DroneFixture fixture;
  fixture.execute("take_off");
  Sky low = kOnGround;
  low.bits = kBatteryLowBit;
  low.battery = 8;
  fixture.live(3.2, low);
  CHECK(fixture.one<Outcome>().reason == "the drone did not take off within 3 s (battery 8 %): battery low");
  CHECK(fixture.last("REF") == kRefGround);
}

TEST_CASE("a drone that is not heard any more after it was cancelled: nobody knows, and it hovers once it is back") {
  DroneFixture fixture(kHovering);
  fixture.execute("hover", R"({"duration": 30})");
  fixture.deliver(MessageType::command, CancelExecution{attempt(), "the run is aborted"}, "drone");
  CHECK(fixture.told<Outcome>().empty());
  fixture.wait(2.1);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  const auto before = fixture.counted("to_robot.stop");
  fixture.live(0.3, kHovering);
  CHECK(fixture.counted("to_robot.stop") == before + 1);
  fixture.told<AdapterState>();
  fixture.deliver(MessageType::request, AdapterStateRequest{}, "drone");
  CHECK_FALSE(fixture.one<AdapterState>().busy);
}

TEST_CASE("a skill that times out or is cancelled stands in the air, without a fence") {
  DroneFixture fixture(kHovering);
  fixture.execute("hover", R"({"duration": 30})");
  fixture.deliver(MessageType::command, CancelExecution{attempt(), "the run is aborted"}, "drone");
  CHECK(fixture.told<Outcome>().empty());
  fixture.live(0.2, kHovering);  // its navdata shows that it stands
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::failed);
  CHECK(fixture.last("REF") == kRefAir);
  CHECK(fixture.answer(fixture.execute("land")) == "failed");  // the same attempt
  CHECK(fixture.answer(fixture.deliver(MessageType::command, order("land", "", 2), "drone")) == "running");
}
