// Flying an AR.Drone: take-off, hover, motion, land, stop, emergency, and what the drone does by itself.
#include "common/drivers/udp-at/test/bench.hpp"

using namespace trb;
using namespace trb::adapter;

using Calls = std::vector<std::string>;

TEST_CASE("take_off: trimmed on level ground, and over once the drone stands in the air") {
  DroneBench bench;
  CHECK(bench.answer(bench.execute("take_off")) == "running");
  CHECK(bench.sent() == Calls{"FTRIM", kRefAir, kHoverCall});
  bench.live(0.5, kOnGround);
  bench.live(2, kTakingOff);
  CHECK(bench.told<Outcome>().empty());
  CHECK(bench.last("REF") == kRefAir);
  bench.tell(kHovering);
  const auto outcome = bench.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::finished);
  CHECK(outcome.duration_s == doctest::Approx(2.5));
}

TEST_CASE("hover: so long, by the node's clock; land: over on the ground") {
  DroneBench bench(kHovering);
  bench.execute("hover", R"({"duration": 4})");
  bench.live(3.9, kHovering);
  CHECK(bench.told<Outcome>().empty());
  bench.live(0.2, kHovering);
  CHECK(bench.one<Outcome>().outcome == TaskOutcome::finished);
  CHECK(bench.last("REF") == kRefAir);

  bench.deliver(MessageType::command, order("land", "", 2), "drone");
  CHECK(bench.sent() == Calls{kRefGround, kHoverCall});
  bench.live(2, kLanding);
  CHECK(bench.told<Outcome>().size() == 2);  // hover's, which nobody has journaled
  bench.tell(kOnGround);
  CHECK(bench.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("a motion never lasts longer than was said, or than a second") {
  DroneBench bench(kHovering);
  CHECK(bench.answer(bench.command("move", "[0, -0.8, 0, 0.05, 2]")) == "ack handed_over");
  CHECK(bench.sent() == Calls{kRefAir, "PCMD,1,0,-1085485875,0,1028443341"});
  bench.live(1.95, kHovering);
  CHECK(bench.last("PCMD") == "PCMD,1,0,-1085485875,0,1028443341");
  bench.live(0.1, kHovering);
  CHECK(bench.last("PCMD") == kHoverCall);
  bench.command("nudge", "");
  bench.live(0.95, kHovering);
  CHECK(bench.last("PCMD") == "PCMD,1,0,-1085485875,0,0");
  bench.live(0.1, kHovering);
  CHECK(bench.last("PCMD") == kHoverCall);
}

TEST_CASE("a motion on the ground is refused: the drone would do nothing and say nothing") {
  DroneBench bench(kOnGround);
  const auto id = bench.command("move", "[0, -0.8, 0, 0, 2]");
  CHECK(bench.nack_of(id).code == "conflict");
  CHECK(bench.nack_of(id).what == "the drone is not in the air");
  CHECK(bench.answer(bench.command("hover", "3")) == "nack conflict");
  CHECK(bench.sent().empty());
  CHECK(bench.answer(bench.command("land", "")) == "ack handed_over");
}

TEST_CASE("two commands at once: the later one counts, and the skill that it ends is told so") {
  DroneBench bench(kHovering);
  bench.execute("hover", R"({"duration": 30})");
  CHECK(bench.answer(bench.command("land", "")) == "nack control_held");
  bench.flags = kFlagTakeControl;
  CHECK(bench.answer(bench.command("land", "")) == "ack handed_over");
  const auto outcome = bench.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::failed);
  CHECK(outcome.reason == "'land' took its place");
  CHECK(bench.last("REF") == kRefGround);
}

TEST_CASE("two skills at once: the second one is refused as busy, nothing is sent for it") {
  DroneBench bench(kHovering);
  bench.execute("hover", R"({"duration": 30})");
  bench.sent();
  const auto second = bench.deliver(MessageType::command, order("land", "", 2), "drone");
  CHECK(bench.answer(second) == "nack busy");
  CHECK(bench.sent().empty());
}

TEST_CASE("a stop in the air stands, says so once the drone stands, and fences; landing needs a release") {
  DroneBench bench(kHovering);
  bench.command("move", "[0, -0.8, 0, 0, 20]");
  Sky moving = kHovering;
  moving.vx = 900;
  bench.live(0.5, moving);
  bench.sent();
  const auto stop = bench.deliver(MessageType::command, Stop{"a person in the way"});
  CHECK(bench.sent() == Calls{kRefAir, kHoverCall});
  bench.live(0.4, moving);
  CHECK(bench.answer(stop).empty());
  bench.live(0.125, kHovering);
  CHECK(bench.answer(stop) == "ack stopped");
  CHECK(bench.answer(bench.command("land", "")) == "nack fenced");
  CHECK(bench.last("REF") == kRefAir);
  CHECK(bench.answer(bench.deliver(MessageType::command, Release{})) == "ack released");
  CHECK(bench.answer(bench.command("land", "")) == "ack handed_over");
}

TEST_CASE("a stop that the drone does not obey is not confirmed") {
  DroneBench bench(kHovering);
  Sky moving = kHovering;
  moving.vx = 900;
  bench.tell(moving);
  const auto stop = bench.deliver(MessageType::command, Stop{""});
  bench.live(2.1, moving);
  CHECK(bench.nack_of(stop).what.find("did not confirm the stop within 2 s") != std::string::npos);
}

TEST_CASE("a stop while it takes off or lands brings it to the ground; with REF land it always does") {
  DroneBench bench(kOnGround);
  bench.execute("take_off");
  bench.live(0.5, kTakingOff);
  bench.deliver(MessageType::command, Stop{""});
  CHECK(bench.last("REF") == kRefGround);
  CHECK(bench.one<Outcome>().outcome == TaskOutcome::interrupted);

  DroneBench landing(kHovering);
  landing.command("land", "");
  landing.tell(kLanding);
  landing.deliver(MessageType::command, Stop{""});
  CHECK(landing.last("REF") == kRefGround);

  Settings settings = drone();
  settings.commands.commands["stop"] = "REF land";
  DroneBench lands(kHovering, settings);
  lands.deliver(MessageType::command, Stop{""});
  CHECK(lands.last("REF") == kRefGround);
}

TEST_CASE("emergency cuts the motors once, recover lifts it once: each ends when the drone says so") {
  DroneBench bench(kHovering);
  const auto cut = bench.command("emergency", "");
  CHECK(bench.answer(cut).empty());
  CHECK(bench.last("REF") == kRefToggle);
  Sky fallen = kOnGround;
  fallen.bits = kEmergencyBit;
  bench.live(0.125, fallen);
  CHECK(bench.answer(cut) == "ack handed_over");
  bench.wait(0.03);
  CHECK(bench.last("REF") == kRefGround);
  CHECK(bench.faults().at(0).text == "emergency: the motors are cut");
  // Told twice it is no toggle: the drone stays as it is.
  const auto again = bench.command("emergency", "");
  bench.live(0.125, fallen);
  CHECK(bench.answer(again) == "ack handed_over");

  CHECK(bench.nack_of(bench.command("take_off", "")).cure.find("command recover") != std::string::npos);
  const auto recover = bench.command("recover", "");
  CHECK(bench.last("REF") == kRefToggle);
  bench.live(0.125, kOnGround);
  CHECK(bench.answer(recover) == "ack handed_over");
  bench.wait(0.03);
  CHECK(bench.last("REF") == kRefGround);
}

TEST_CASE("an emergency that the drone does not confirm is said, and is not sent for ever") {
  DroneBench bench(kHovering);
  const auto cut = bench.command("emergency", "");
  bench.live(1.6, kHovering);
  CHECK(bench.nack_of(cut).what == "the drone did not confirm 'emergency' within 1.5 s");
  bench.wait(0.03);
  CHECK(bench.last("REF") == kRefGround);
}

TEST_CASE("an emergency in the middle of a skill: the skill fails, and everybody is told why, once") {
  DroneBench bench(kHovering);
  bench.execute("hover", R"({"duration": 30})");
  Sky fallen = kOnGround;
  fallen.bits = kEmergencyBit | kCutoutBit;
  bench.live(1, fallen);
  const auto outcome = bench.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::failed);
  CHECK(outcome.reason == "the drone's motors were cut (battery 76 %): cutout: a motor was held or stopped");
  const auto faults = bench.faults();
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].capability == "fly");
  CHECK(faults[0].severity == Severity::critical);
  CHECK(faults[0].text == "emergency: the motors are cut (cutout: a motor was held or stopped)");
  CHECK(bench.last("REF") == kRefGround);
}

TEST_CASE("a low battery is a fault at its edge, and a drone that comes down by itself is not sent up again") {
  DroneBench bench(kHovering);
  bench.execute("hover", R"({"duration": 30})");
  Sky low = kHovering;
  low.bits = kBatteryLowBit;
  low.battery = 19;
  bench.live(1, low);
  const auto faults = bench.faults();
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].severity == Severity::urgent);
  CHECK(faults[0].text == "battery low: 19 %");
  low.control = 8;
  bench.live(0.25, low);
  CHECK(bench.one<Outcome>().reason == "the drone came down by itself (battery 19 %): battery low");
  CHECK(bench.last("REF") == kRefGround);
}

TEST_CASE("a drone that does not take off: said after 3 s, and it is not left to take off later") {
  DroneBench bench;
  bench.execute("take_off");
  Sky low = kOnGround;
  low.bits = kBatteryLowBit;
  low.battery = 8;
  bench.live(3.2, low);
  CHECK(bench.one<Outcome>().reason == "the drone did not take off within 3 s (battery 8 %): battery low");
  CHECK(bench.last("REF") == kRefGround);
}

TEST_CASE("a skill that times out or is cancelled stands in the air, without a fence") {
  DroneBench bench(kHovering);
  bench.execute("hover", R"({"duration": 30})");
  bench.deliver(MessageType::command, CancelExecution{attempt(), "the run is aborted"}, "drone");
  CHECK(get<Outcome>(bench.told<Outcome>().at(0).body).outcome == TaskOutcome::failed);
  CHECK(bench.last("REF") == kRefAir);
  CHECK(bench.answer(bench.execute("land")) == "failed");  // the same attempt
  CHECK(bench.answer(bench.deliver(MessageType::command, order("land", "", 2), "drone")) == "running");
}
