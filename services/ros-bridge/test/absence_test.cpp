// A worker, a master or a mode-adapter that is late, hangs or goes: nobody waits for ever, and nothing is published
// late.
#include "services/ros-bridge/test/bridge_fixture.hpp"

using namespace trb;
using namespace trb::ros;
using namespace trb::ros::test;

TEST_CASE("nobody waits for ever") {
  Fixture fixture;
  fixture.up();
  fixture.command(1, BridgeAction::ask, "/odom");
  fixture.command(2, BridgeAction::publish, "/cmd_vel", "{}");
  for (int i = 0; i < 8; ++i) {
    fixture.worker(Word::alive, {"up", ""});
    fixture.wait(std::chrono::seconds(1));
  }
  const std::string told = fixture.told();
  CHECK(told.find("1 timeout: nobody has said anything on /odom\n") != std::string::npos);
  CHECK(told.find("2 timeout: /cmd_vel: ROS did not take it in time\n") != std::string::npos);
}

TEST_CASE("what a worker that is blocked does not publish in time is refused, and dropped there") {
  Fixture fixture;
  const MonotonicTime given = fixture.now.mono;
  const WorkerMessage publish = fixture.publish();
  // As a time, not as a patience: that would begin once the worker reads it.
  CHECK(publish.parts[5] == std::to_string((given + std::chrono::seconds(5)).ns));
  const auto wait_alive = [&] {
    fixture.worker(Word::alive, {"up", ""});
    fixture.wait(std::chrono::milliseconds(3499));
  };
  wait_alive();
  wait_alive();
  CHECK(fixture.told().empty());
  CHECK(fixture.said().empty());
  wait_alive();
  CHECK(fixture.told() == "1 timeout: /cmd_vel: ROS did not take it in time\n");
  const auto said = fixture.said();
  REQUIRE(said.size() == 1);
  CHECK(said[0].word == Word::drop);
  CHECK(said[0].parts == std::vector<Bytes>{publish.parts[0]});
}

TEST_CASE("a master that hangs is told of, and the worker that hangs with it is killed") {
  Fixture fixture;
  fixture.up();
  fixture.wait(std::chrono::seconds(6));
  REQUIRE(fixture.core.take_worker_output().kill);
  fixture.told();
  REQUIRE_FALSE(fixture.states.empty());
  CHECK_FALSE(fixture.states.back().up);
  CHECK(fixture.states.back().detail == "the ROS master at http://10.0.0.9:11311 does not answer");
  const auto before = fixture.states.back().connection;
  fixture.core.on_worker_started(fixture.now, fixture.out);
  fixture.up();
  fixture.command(1, BridgeAction::watch, "/odom");
  CHECK(fixture.said().back().word == Word::subscribe);
  CHECK(fixture.states.back().up);
  CHECK(fixture.states.back().connection == before);
}

TEST_CASE("an absent master is told of, and commands are refused with it") {
  Fixture fixture;
  fixture.worker(Word::alive, {"absent", "no ROS master at http://10.0.0.9:11311"});
  fixture.command(1, BridgeAction::publish, "/cmd_vel", "{}");
  CHECK(fixture.told() == "1 robot_offline: no ROS master at http://10.0.0.9:11311\n");
}

TEST_CASE("what waits at the worker when the master goes is dropped there: its sender was refused") {
  Fixture fixture;
  const WorkerMessage publish = fixture.publish();
  fixture.worker(Word::alive, {"absent", "no ROS master at http://10.0.0.9:11311"});
  const auto said = fixture.said();
  REQUIRE(said.size() == 1);
  CHECK(said[0].word == Word::drop);
  CHECK(said[0].parts[0] == publish.parts[0]);
  fixture.worker(Word::alive, {"absent", "no ROS master at http://10.0.0.9:11311, still"});
  CHECK(fixture.said().empty());
}

TEST_CASE("a topic that nobody listens to any more once the master is back is unsubscribed from") {
  Fixture fixture;
  const auto live = [&](const char* state, int times) {
    for (int i = 0; i < times; ++i) {
      fixture.worker(Word::alive, {state, ""});
      fixture.wait(std::chrono::seconds(1));
    }
  };
  fixture.up();
  fixture.command(1, BridgeAction::watch, "/odom", "", {"x"});
  fixture.command(2, BridgeAction::watch, "/scan");
  live("absent", 3);
  fixture.worker(Word::message, odometry(1, 2));
  CHECK(fixture.told().empty());  // the mode-adapter has given its watches up
  fixture.up();
  fixture.said();
  fixture.command(3, BridgeAction::watch, "/odom", "", {"x"});
  const auto again = fixture.said();
  REQUIRE(again.size() == 1);
  CHECK(again[0].word == Word::subscribe);  // of one that is subscribed to: it gives what ROS keeps
  fixture.worker(Word::kept, odometry(1, 2));
  CHECK(fixture.told() == "3 1.0\n");
  live("up", 31);
  const auto said = fixture.said();
  REQUIRE(said.size() == 1);
  CHECK(said[0].word == Word::unsubscribe);
  CHECK(said[0].parts == std::vector<Bytes>{"/scan"});
}

TEST_CASE("a mode-adapter that was restarted starts anew; nobody else is listened to") {
  Fixture fixture;
  fixture.up();
  fixture.command(1, BridgeAction::watch, "/odom");
  fixture.command(1, BridgeAction::ask, "/scan", "", {}, "ridgeback", kAdapter + 1);
  fixture.worker(Word::message, odometry(1, 2));
  CHECK(fixture.told().empty());
  fixture.command(2, BridgeAction::publish, "/cmd_vel", "{}", {}, "ur3");
  fixture.said();
  CHECK(fixture.told().empty());
}

TEST_CASE("a worker's garbage ends it") {
  Fixture fixture;
  fixture.up();
  fixture.core.on_worker_bytes(Bytes("\xff\xff\xff\x7f", 4), fixture.now, fixture.out);
  CHECK(fixture.core.take_worker_output().kill);
  std::vector<WorkerMessage> none;
  for (const char* bytes : {"\x01\0\0\0\x63", "\x01\0\0\0\x05", "\x06\0\0\0\x06\x09\0\0\0x"}) {
    CHECK_FALSE(WorkerReader().add(Bytes(bytes, bytes[0] + 4), none));
  }
}
