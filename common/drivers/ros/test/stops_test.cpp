// What is published no more, and what is published first: stops, halts, and what they overtake.
#include "common/drivers/ros/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

TEST_CASE("a stop goes to every topic that it names, overtakes what waits, and is answered once all have it") {
  OnlineRos fixture;
  const auto waiting = fixture.command("move", "[1]");
  const auto moves = fixture.asked();
  const auto id = fixture.deliver(MessageType::command, Stop{"fire"});
  CHECK(fixture.answer(waiting) == "nack fenced");
  const auto asked = fixture.asked();
  REQUIRE(asked.size() == 3);
  CHECK(asked[0].action == BridgeAction::unwatch);
  CHECK(asked[0].token == moves.at(0).token);
  CHECK(asked[1].data == "{}");
  CHECK(asked[2].name == "/arm/stop");
  CHECK(asked[1].timeout_s == 20);  // a slow ROS master makes it late, which is better than never
  CHECK(asked[2].timeout_s == 20);
  fixture.tell(asked[1].token, BridgeResult::done);
  CHECK(fixture.answer(id).empty());
  fixture.tell(asked[2].token, BridgeResult::done);
  fixture.wait(0.1);
  CHECK(fixture.answer(id) == "ack stopped");
}

TEST_CASE("of a command that was refused in part nothing more is published") {
  Settings settings = ridgeback();
  settings.commands.commands["move"] = "/lamp std_msgs/Empty {}\n/cmd_vel";
  OnlineRos fixture(std::move(settings));
  const auto id = fixture.command("move", "[1]");
  const auto lamp = fixture.asked().at(0);
  fixture.tell(lamp.token, BridgeResult::failed, "", "unknown_target");
  CHECK(fixture.answer(id) == "nack unknown_target");
  const auto asked = fixture.asked();  // the speed may still wait for a subscriber
  REQUIRE(asked.size() == 1);
  CHECK(asked[0].action == BridgeAction::unwatch);
  CHECK(asked[0].token == lamp.token);
}

TEST_CASE("a stop that one of its topics has refused goes to the others, but not after a release") {
  OnlineRos fixture;
  const auto id = fixture.deliver(MessageType::command, Stop{"fire"});
  const auto stop = fixture.asked().at(0);
  fixture.tell(stop.token, BridgeResult::failed, "", "timeout");
  CHECK(fixture.asked().empty());
  SUBCASE("it is not confirmed") {
    fixture.tell(stop.token, BridgeResult::done);
    fixture.wait(0.1);
    CHECK(fixture.answer(id).empty());
    fixture.deliver(MessageType::command, Release{});
    CHECK(fixture.asked().empty());
  }
  SUBCASE("a release drops what waits of it") {
    fixture.deliver(MessageType::command, Release{});
    const auto asked = fixture.asked();
    REQUIRE(asked.size() == 1);
    CHECK(asked[0].action == BridgeAction::unwatch);
    CHECK(asked[0].token == stop.token);
  }
}

TEST_CASE("what nobody waits for any more is not published later: the message's time is over, or the skill's") {
  OnlineRos fixture;
  fixture.remaining_ms = 700;
  const auto id = fixture.command("move", "[1]");
  const auto move = fixture.asked().at(0);
  CHECK(move.timeout_s == doctest::Approx(0.7));
  fixture.wait(1);
  CHECK(fixture.answer(id) == "nack timeout");
  auto asked = fixture.asked();
  REQUIRE(asked.size() == 1);
  CHECK(asked[0].action == BridgeAction::unwatch);
  CHECK(asked[0].token == move.token);

  OnlineRos cancelled;
  const Execute drive{{"run", "t1", 1, 1}, 1, kInstance, "go_to", R"({"place":"dock"})", 0};
  cancelled.deliver(MessageType::command, drive, "ridgeback");
  const auto goal = cancelled.asked().at(0);
  CHECK(goal.timeout_s == 5);
  cancelled.deliver(MessageType::command, CancelExecution{drive.key, "enough"}, "ridgeback");
  asked = cancelled.asked();
  REQUIRE(asked.size() == 3);
  CHECK(asked[0].action == BridgeAction::unwatch);
  CHECK(asked[0].token == goal.token);
  CHECK(asked[1].name == "/cmd_vel");
}

TEST_CASE("a stop drops a release that waits, and a release a stop") {
  Settings settings = ridgeback();
  settings.commands.commands["release"] = "/brake std_msgs/Bool {\"data\": false}";
  OnlineRos fixture(std::move(settings));
  fixture.deliver(MessageType::command, Release{});
  const auto release = fixture.asked().at(0);
  fixture.deliver(MessageType::command, Stop{"fire"});
  auto asked = fixture.asked();
  REQUIRE(asked.size() == 3);
  CHECK(asked[0].action == BridgeAction::unwatch);
  CHECK(asked[0].token == release.token);
  const auto stop = asked[1];
  fixture.deliver(MessageType::command, Release{});
  asked = fixture.asked();
  REQUIRE(asked.size() == 2);
  CHECK(asked[0].action == BridgeAction::unwatch);
  CHECK(asked[0].token == stop.token);
  CHECK(asked[1].name == "/brake");
}

TEST_CASE("a bridge that was only slow publishes nothing that was refused meanwhile") {
  RosFixture fixture;
  fixture.bridge(true);
  const auto watch = fixture.asked().at(0);
  const auto id = fixture.command("move", "[1]");
  const auto move = fixture.asked().at(0);
  fixture.wait(4.1);
  CHECK(fixture.answer(id) == "nack robot_offline");
  const auto asked = fixture.asked();
  REQUIRE(asked.size() == 2);
  CHECK(asked[0].action == BridgeAction::unwatch);
  CHECK(asked[0].token == watch.token);
  CHECK(asked[1].token == move.token);
}

TEST_CASE("a stop stays with a bridge that is silent, and is given again, in its place, when that speaks") {
  RosFixture fixture;
  fixture.bridge(true);
  const auto watch = fixture.asked().at(0);
  fixture.deliver(MessageType::command, Stop{"fire"});
  const auto stop = fixture.asked().at(0);
  fixture.wait(4.1);
  auto asked = fixture.asked();
  REQUIRE(asked.size() == 1);
  CHECK(asked[0].token == watch.token);
  fixture.bridge(true);
  asked = fixture.asked();
  REQUIRE(asked.size() == 4);
  CHECK(asked[0].action == BridgeAction::unwatch);
  CHECK(asked[0].token == stop.token);
  CHECK(asked[1].action == BridgeAction::watch);
  CHECK(asked[2].name == stop.name);
  fixture.bridge(false);
  fixture.bridge(true);
  CHECK(fixture.asked().size() == 3);  // it is forgotten then
}

TEST_CASE("a halt that nothing subscribes to: nobody knows; it is published again when the bridge is back") {
  OnlineRos fixture;
  const Execute drive{{"run", "t1", 1, 1}, 1, kInstance, "go_to", R"({"place":"dock"})", 0};
  fixture.deliver(MessageType::command, drive, "ridgeback");
  for (const auto& one : fixture.asked()) fixture.tell(one.token, BridgeResult::done);
  fixture.deliver(MessageType::command, CancelExecution{drive.key, "enough"}, "ridgeback");
  const auto stop = fixture.asked();
  REQUIRE(stop.size() == 2);
  fixture.tell(stop[0].token, BridgeResult::failed, "", "unknown_topic");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  fixture.bridge(false);
  fixture.asked();
  fixture.bridge(true);
  const auto again = fixture.asked();
  CHECK(std::ranges::count(again, stop[0].name, &BridgeCommand::name) == 1);
}
