// The ros mode: what is sent to the bridge, and what its answers mean.
#include "common/drivers/ros/driver.hpp"
#include "common/drivers/ros/test/fixture.hpp"
#include "common/drivers/vendor_faults.hpp"

using namespace trb;
using namespace trb::adapter;

TEST_CASE("a command is published on the topic that commands.json names, as its sender wrote it") {
  OnlineRos fixture;
  const auto id = fixture.command("move", "[0.5,0,0,0,0,0.3]");
  const auto asked = fixture.asked();
  REQUIRE(asked.size() == 1);
  CHECK(asked[0].action == BridgeAction::publish);
  CHECK(asked[0].name == "/cmd_vel");
  CHECK(asked[0].type.empty());
  CHECK(asked[0].data == "[0.5,0,0,0,0,0.3]");
  CHECK(fixture.answer(id).empty());
  fixture.tell(asked[0].token, BridgeResult::done);
  CHECK(fixture.answer(id) == "ack handed_over");
}

TEST_CASE("a template's items are JSON, whatever they hold") {
  OnlineRos fixture;
  fixture.command("go_to", R"([1.5, "\"}, \"x\": {"])");
  const auto asked = fixture.asked();
  REQUIRE(asked.size() == 1);
  CHECK(asked[0].type == "geometry_msgs/PoseStamped");
  CHECK(asked[0].data == R"({"pose":{"position":{"x":1.5,"y":"\"}, \"x\": {"}}})");
  const auto id = fixture.command("move", "hello");
  CHECK(fixture.answer(id) == "nack bad_value");
}

TEST_CASE("a refusal of the bridge is the sender's answer") {
  OnlineRos fixture;
  const auto id = fixture.command("move", "[1]");
  fixture.tell(fixture.asked().at(0).token, BridgeResult::failed, "", "bad_value");
  CHECK(fixture.answer(id) == "nack bad_value");
}

TEST_CASE("a request is answered with the topic's next message") {
  OnlineRos fixture;
  const auto id = fixture.send(MessageType::request, "scan", "");
  const auto asked = fixture.asked();
  REQUIRE(asked.size() == 1);
  CHECK(asked[0].action == BridgeAction::ask);
  CHECK(asked[0].name == "/scan");
  fixture.tell(asked[0].token, BridgeResult::value, R"({"ranges":[1.0]})");
  CHECK(fixture.answer(id) == R"({"ranges":[1.0]})");
  fixture.tell(asked[0].token, BridgeResult::value, "{}");
  CHECK(fixture.answer(id) == R"({"ranges":[1.0]})");
}

TEST_CASE("requests that wait for a topic take no places of commands, and commands none of requests") {
  OnlineRos fixture;
  for (int i = 0; i < 64; ++i) fixture.send(MessageType::request, "scan", "", "nosy");
  CHECK(fixture.asked().size() == 64);
  const auto command = fixture.command("move", "[1]");
  const auto asked = fixture.asked();
  REQUIRE(asked.size() == 1);
  fixture.tell(asked[0].token, BridgeResult::done);
  CHECK(fixture.answer(command) == "ack handed_over");
  OnlineRos busy;
  for (int i = 0; i < 64; ++i) busy.command("move", "[1]");
  CHECK(busy.answer(busy.command("move", "[1]")) == "nack queue_full");
  CHECK(busy.answer(busy.send(MessageType::request, "scan", "")).empty());
}

TEST_CASE("without ROS the robot is offline and says why; what was under way is not known") {
  RosFixture fixture;
  fixture.bridge(false, 1, "no ROS master at http://10.0.0.9:11311");
  const auto profiles = fixture.told<NodeProfile>();
  CHECK(get<NodeProfile>(profiles.back().body).detail == "no ROS master at http://10.0.0.9:11311");
  auto id = fixture.command("move", "[1]");
  CHECK(fixture.answer(id) == "nack robot_offline");
  fixture.bridge(true);
  fixture.asked();
  id = fixture.command("move", "[1]");
  CHECK(fixture.answer(id).empty());
  fixture.bridge(false, 1, "the ROS master does not answer");
  CHECK(fixture.answer(id) == "nack robot_offline");
  const auto told = fixture.told<RobotConnection>();
  REQUIRE(told.size() == 1);
  CHECK(get<RobotConnection>(told[0].body).detail == "the ROS master does not answer");
}

TEST_CASE("a bridge that has started anew, or says nothing for 4 s, has forgotten what was asked") {
  RosFixture fixture;
  fixture.bridge(true, 1);
  fixture.asked();
  auto id = fixture.command("move", "[1]");
  fixture.asked();
  fixture.bridge(true, 2);
  CHECK(fixture.answer(id) == "nack robot_offline");
  CHECK(fixture.asked().size() == 1);  // watches again
  id = fixture.command("move", "[1]");
  fixture.wait(5);
  CHECK(fixture.answer(id) == "nack robot_offline");
}

TEST_CASE("another node cannot play the bridge") {
  RosFixture fixture;
  fixture.deliver(MessageType::information, BridgeState{1, true, ""}, "ur3");
  CHECK(fixture.answer(fixture.command("move", "[1]")) == "nack robot_offline");
}
