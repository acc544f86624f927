// What commands of a mode-adapter become at the worker, and what the worker says for the mode-adapter.
#include "services/ros-bridge/test/bridge_fixture.hpp"

using namespace trb;
using namespace trb::ros;
using namespace trb::ros::test;

TEST_CASE("a command becomes the wire of the topic's own type, which the master is asked for once") {
  Fixture fixture;
  fixture.up();
  fixture.command(1, BridgeAction::publish, "/cmd_vel", "[0.5,0,0,0,0,0]");
  auto said = fixture.said();
  REQUIRE(said.size() == 1);
  CHECK(said[0].word == Word::look_up);
  fixture.worker(Word::type, {"/cmd_vel", "geometry_msgs/Twist"});
  said = fixture.said();
  REQUIRE(said.size() == 1);
  CHECK(said[0].word == Word::publish);
  CHECK(said[0].parts[2] == "geometry_msgs/Twist");
  CHECK(said[0].parts[3] == "9f195f881246fdfa2798d1d3eebca84a");
  CHECK(said[0].parts[6].size() == 48);
  fixture.worker(Word::published, {said[0].parts[0]});
  CHECK(fixture.told() == "1 done\n");
  fixture.command(2, BridgeAction::publish, "/cmd_vel", R"({"linear":{"x":1}})");
  said = fixture.said();
  REQUIRE(said.size() == 1);
  CHECK(said[0].word == Word::publish);
}

TEST_CASE("a definition to which nobody subscribes is read again: a person compares the sums and puts in the robot's") {
  std::string definition = "float64 speed\n";
  Fixture fixture([&](const std::string&) -> Result<std::string> { return definition; });
  fixture.up();
  fixture.command(1, BridgeAction::publish, "/speed", "[1]");
  fixture.worker(Word::type, {"/speed", "demo/Speed"});
  const WorkerMessage before = fixture.said().back();
  definition = "float32 speed\n";
  fixture.worker(Word::failed, {before.parts[0], "timeout", "/speed: nobody subscribes", "compare the sums"});
  fixture.command(2, BridgeAction::publish, "/speed", "[1]");
  fixture.worker(Word::type, {"/speed", "demo/Speed"});
  const WorkerMessage after = fixture.said().back();
  CHECK(after.word == Word::publish);
  CHECK(after.parts[3] != before.parts[3]);
  CHECK(after.parts[6].size() == 4);
}

TEST_CASE("what cannot be published is refused, and by its field") {
  Fixture fixture;
  fixture.up();
  fixture.command(1, BridgeAction::publish, "/cmd_vel", "[1,2]");
  fixture.command(2, BridgeAction::publish, "/cmd_vel", R"({"linear":{"w":1}})");
  fixture.worker(Word::type, {"/cmd_vel", "geometry_msgs/Twist"});
  CHECK(fixture.told() ==
        "1 bad_value: geometry_msgs/Twist: 2 values, where 6 are needed\n"
        "2 unknown_key: linear: w: no field of geometry_msgs/Vector3\n");
  fixture.command(3, BridgeAction::publish, "/gone", "{}");
  fixture.worker(Word::type, {"/gone", ""});
  CHECK(fixture.told() == "3 unknown_target: the ROS master knows no topic /gone\n");
  fixture.command(4, BridgeAction::publish, "/odd", "{}");
  fixture.worker(Word::type, {"/odd", "demo/Odd"});
  CHECK(fixture.told() == "4 missing: demo/Odd: no definition\n");
  fixture.command(5, BridgeAction::publish, "no topic", "{}");
  fixture.command(5, BridgeAction::ask, "2d_scan");
  fixture.command(5, BridgeAction::publish, "_vel", "{}");
  CHECK(fixture.told() ==
        "5 bad_value: 'no topic' is no topic\n"
        "5 bad_value: '2d_scan' is no topic\n"
        "5 bad_value: '_vel' is no topic\n");
  fixture.command(6, BridgeAction::publish, "/cmd_vel", "{}");
  fixture.said();
  fixture.worker(Word::failed, {"3", "timeout", "/cmd_vel: nobody subscribes", ""});
  fixture.wait(std::chrono::milliseconds(1));
  CHECK(fixture.told().empty());  // of another publication
}

TEST_CASE("an ask is answered by the topic's next message, a watch by each, ten times a second at most") {
  Fixture fixture;
  fixture.up();
  fixture.command(1, BridgeAction::ask, "/odom");
  fixture.command(2, BridgeAction::watch, "/odom", "", {"x"});
  const auto said = fixture.said();
  REQUIRE(said.size() == 2);  // the worker has one subscription for both
  for (const WorkerMessage& one : said) CHECK(one.word == Word::subscribe);
  fixture.worker(Word::message, odometry(1, 2));
  CHECK(fixture.told() == "1 {\"x\":1.0,\"y\":2.0}\n2 1.0\n");
  fixture.worker(Word::message, odometry(3, 2));
  CHECK(fixture.told().empty());
  fixture.wait(std::chrono::milliseconds(100));
  CHECK(fixture.told() == "2 3.0\n");
  fixture.wait(std::chrono::milliseconds(100));
  fixture.worker(Word::message, odometry(4, 2));
  CHECK(fixture.told() == "2 4.0\n");
  fixture.command(3, BridgeAction::ask, "/odom", "", {"y", "z"});
  fixture.worker(Word::message, odometry(4, 2));
  CHECK(fixture.told() == "3 bad_value: the message has no z\n");
}

TEST_CASE("of messages that come too fast a watch is told the newest, also if no other follows") {
  Fixture fixture;
  fixture.up();
  fixture.command(1, BridgeAction::watch, "/odom", "", {"x"});
  fixture.worker(Word::message, odometry(1, 0));
  CHECK(fixture.told() == "1 1.0\n");
  fixture.wait(std::chrono::milliseconds(30));
  fixture.worker(Word::message, odometry(2, 0));
  fixture.wait(std::chrono::milliseconds(30));
  fixture.command(2, BridgeAction::watch, "/odom", "", {"x"});
  fixture.command(3, BridgeAction::ask, "/odom", "", {"x"});
  CHECK(fixture.told().empty());
  fixture.worker(Word::message, odometry(3, 0));
  CHECK(fixture.told() == "2 3.0\n3 3.0\n");
  fixture.wait(std::chrono::milliseconds(39));
  CHECK(fixture.told().empty());
  fixture.wait(std::chrono::milliseconds(1));
  CHECK(fixture.told() == "1 3.0\n");
  fixture.wait(std::chrono::milliseconds(900));
  CHECK(fixture.told().empty());  // once
  fixture.worker(Word::message, odometry(4, 0));
  fixture.worker(Word::message, odometry(5, 0));
  fixture.command(1, BridgeAction::unwatch, "/odom");
  fixture.command(2, BridgeAction::unwatch, "");
  fixture.told();
  fixture.wait(std::chrono::milliseconds(900));
  CHECK(fixture.told().empty());
}

TEST_CASE(
    "who begins to listen to a topic that is listened to already is told what ROS keeps of it, nobody else again") {
  Fixture fixture;
  fixture.up();
  fixture.command(1, BridgeAction::watch, "/odom", "", {"x"});
  fixture.worker(Word::message, odometry(1, 0));
  CHECK(fixture.told() == "1 1.0\n");
  fixture.said();
  fixture.wait(std::chrono::milliseconds(200));
  fixture.command(2, BridgeAction::ask, "/odom", "", {"x"});
  fixture.command(3, BridgeAction::watch, "/odom", "", {"x"});
  const auto said = fixture.said();
  REQUIRE(said.size() == 2);
  CHECK(said[0].word == Word::subscribe);
  CHECK(said[0].parts == std::vector<Bytes>{"/odom"});
  fixture.worker(Word::kept, odometry(1, 0));
  CHECK(fixture.told() == "2 1.0\n3 1.0\n");
  fixture.worker(Word::kept, odometry(1, 0));
  fixture.wait(std::chrono::milliseconds(200));
  CHECK(fixture.told().empty());
  // A newer message that is still owed to others is what counts.
  fixture.worker(Word::message, odometry(2, 0));
  CHECK(fixture.told() == "1 2.0\n3 2.0\n");
  fixture.worker(Word::message, odometry(3, 0));
  fixture.command(4, BridgeAction::watch, "/odom", "", {"x"});
  fixture.worker(Word::kept, odometry(1, 0));
  CHECK(fixture.told() == "4 3.0\n");
  fixture.wait(std::chrono::milliseconds(100));
  CHECK(fixture.told() == "1 3.0\n3 3.0\n");
}

TEST_CASE("an adapter that was restarted is told what ROS keeps of the topics of the one before") {
  Fixture fixture;
  fixture.up();
  fixture.command(1, BridgeAction::watch, "/odom", "", {"x"});
  fixture.worker(Word::message, odometry(1, 0));
  CHECK(fixture.told() == "1 1.0\n");
  fixture.said();
  fixture.command(1, BridgeAction::watch, "/odom", "", {"x"}, "ridgeback", kAdapter + 1);
  REQUIRE(fixture.said().size() == 1);
  fixture.worker(Word::kept, odometry(1, 0));
  CHECK(fixture.told() == "1 1.0\n");
}

TEST_CASE("what is dropped is not published once its type is known, nor once somebody subscribes") {
  Fixture fixture;
  fixture.up();
  fixture.command(1, BridgeAction::publish, "/cmd_vel", "{}");
  fixture.command(2, BridgeAction::publish, "/cmd_vel", "{}");
  fixture.command(1, BridgeAction::unwatch, "");
  fixture.said();
  fixture.worker(Word::type, {"/cmd_vel", "geometry_msgs/Twist"});
  const auto publish = fixture.said();
  REQUIRE(publish.size() == 1);
  CHECK(publish[0].word == Word::publish);
  fixture.command(2, BridgeAction::unwatch, "");
  const auto said = fixture.said();
  REQUIRE(said.size() == 1);
  CHECK(said[0].word == Word::drop);
  CHECK(said[0].parts == std::vector<Bytes>{publish[0].parts[0]});
  fixture.worker(Word::published, {publish[0].parts[0]});  // it had left already
  fixture.command(3, BridgeAction::ask, "/odom");
  fixture.command(3, BridgeAction::unwatch, "");
  fixture.command(4, BridgeAction::unwatch, "");
  fixture.worker(Word::message, odometry(1, 2));
  CHECK(fixture.told().empty());
}

TEST_CASE("what an adapter that is gone wanted published is dropped at the worker") {
  Fixture fixture;
  const WorkerMessage publish = fixture.publish();
  fixture.command(1, BridgeAction::ask, "/scan", "", {}, "ridgeback", kAdapter + 1);
  const auto said = fixture.said();
  REQUIRE(said.size() == 2);
  CHECK(said[0].word == Word::drop);
  CHECK(said[0].parts[0] == publish.parts[0]);
}

TEST_CASE("a message that the worker cannot take ends the asks, and no watch") {
  Fixture fixture;
  fixture.up();
  fixture.command(1, BridgeAction::watch, "/odom", "", {"x"});
  fixture.command(2, BridgeAction::ask, "/odom");
  fixture.worker(Word::unread, {"/odom", "too_large", "/odom: a message of over 1 MiB", ""});
  CHECK(fixture.told() == "1 \n2 too_large: /odom: a message of over 1 MiB\n");
  fixture.wait(std::chrono::milliseconds(100));
  fixture.worker(Word::message, odometry(1, 2));
  CHECK(fixture.told() == "1 1.0\n");
}

TEST_CASE("a topic's refusal by the worker is told to all who listen to it, and to nobody else") {
  Fixture fixture;
  fixture.up();
  fixture.command(1, BridgeAction::watch, "/odom");
  fixture.command(2, BridgeAction::ask, "/odom");
  fixture.command(3, BridgeAction::ask, "/scan");
  fixture.worker(Word::topic_failed, {"/odom", "bad_value", "/odom: no name", ""});
  CHECK(fixture.told() ==
        "1 bad_value: /odom: no name\n"
        "2 bad_value: /odom: no name\n");
  fixture.worker(Word::topic_failed, {"/gone", "bad_value", "", ""});
  fixture.worker(Word::message, odometry(1, 2));
  CHECK(fixture.told().empty());
  fixture.said();
  for (int i = 0; i < 40; ++i) {
    fixture.worker(Word::alive, {"up", ""});
    fixture.wait(std::chrono::seconds(1));
  }
  CHECK(fixture.said().front().parts == std::vector<Bytes>{"/odom"});  // nobody listens to it any more
}
