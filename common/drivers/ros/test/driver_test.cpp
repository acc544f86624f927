// The ros mode: what is sent to the bridge, and what its answers mean.
#include <algorithm>
#include <memory>

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

TEST_CASE("a skill that ends at a position is seen to end by the watched topic") {
  RosFixture fixture;
  fixture.bridge(true);
  const auto watched = fixture.asked();
  REQUIRE(watched.size() == 1);
  CHECK(watched[0].action == BridgeAction::watch);
  CHECK(watched[0].paths == std::vector<std::string>{"pose.pose.position.x", "pose.pose.position.y"});
  fixture.deliver(MessageType::command, Execute{{"run", "t1", 1, 1}, 1, kInstance, "go_to", R"({"place":"dock"})", 0},
                  "ridgeback");
  const auto asked = fixture.asked();
  REQUIRE(asked.size() == 1);
  CHECK(asked[0].data == R"({"pose":{"position":{"x":1,"y":2}}})");
  fixture.tell(asked[0].token, BridgeResult::done);
  fixture.wait(0.2);
  fixture.tell(watched[0].token, BridgeResult::value, "[0.5,1.0]");
  CHECK(fixture.told<Outcome>().empty());
  fixture.wait(0.2);
  fixture.tell(watched[0].token, BridgeResult::value, "[1.01,1.99]");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("a value that the robot has not measured stays null for its reader, and ends no skill") {
  RosFixture fixture;
  fixture.bridge(true);
  const auto watched = fixture.asked();
  REQUIRE(watched.size() == 1);
  fixture.deliver(MessageType::command, Execute{{"run", "t1", 1, 1}, 1, kInstance, "go_to", R"({"place":"dock"})", 0},
                  "ridgeback");
  const auto asked = fixture.asked();
  REQUIRE(asked.size() == 1);
  fixture.tell(asked[0].token, BridgeResult::done);
  fixture.wait(0.2);
  // The dock is at 1, 2: with the null left out, x would be taken for 1 and y for 2.
  fixture.tell(watched[0].token, BridgeResult::value, "[null,1.0,2.0]");
  CHECK(fixture.told<Outcome>().empty());
  const auto id = fixture.send(MessageType::request, "scan", "");
  const auto scan = fixture.asked();
  REQUIRE(scan.size() == 1);
  fixture.tell(scan[0].token, BridgeResult::value, R"({"ranges":[null,1.0]})");
  CHECK(fixture.answer(id) == R"({"ranges":[null,1.0]})");
}

TEST_CASE("a skill ends as its state says: well at one value, badly at another") {
  for (const auto& [said, outcome] : {std::pair{"0", TaskOutcome::finished}, {"2", TaskOutcome::failed}}) {
    Settings settings = ridgeback();
    settings.description.skills[0].end = {EndKind::state, "task", 0, 0.01, "", 0, 2};
    settings.commands.requests["task"] = "/task data";
    RosFixture fixture(std::move(settings));
    fixture.bridge(true);
    const auto watched = fixture.asked();
    REQUIRE(watched.size() == 1);
    CHECK(watched[0].name == "/task");
    fixture.deliver(MessageType::command, Execute{{"run", "t1", 1, 1}, 1, kInstance, "go_to", R"({"place":"dock"})", 0},
                    "ridgeback");
    fixture.tell(fixture.asked().at(0).token, BridgeResult::done);
    fixture.wait(0.2);
    fixture.tell(watched[0].token, BridgeResult::value, "1");
    CHECK(fixture.told<Outcome>().empty());
    fixture.tell(watched[0].token, BridgeResult::value, said);
    CHECK(fixture.one<Outcome>().outcome == outcome);
  }
}

namespace {

/// A skill that ends with the state 0, fails with 2; the robot tells its state all the time.
struct TaskFixture : RosFixture {
  TaskFixture() : RosFixture(fetching()) {
    bridge(true);
    watch = asked().at(0).token;
  }
  static Settings fetching() {
    Settings settings = ridgeback();
    settings.description.skills[0].end = {EndKind::state, "task", 0, 0.01, "", 0, 2};
    settings.commands.requests["task"] = "/task data";
    return settings;
  }
  void task(const char* state, double later_s = 0) {
    wait(later_s);
    tell(watch, BridgeResult::value, state);
  }
  void execute(double timeout_s = 0) {
    const Execute order{{"run", "t1", 1, ++number}, 1, kInstance, "go_to", R"({"place":"dock"})", timeout_s};
    deliver(MessageType::command, order, "ridgeback");
    tell(asked().at(0).token, BridgeResult::done);
  }
  std::uint64_t watch = 0;
  std::uint32_t number = 0;
};

}  // namespace

TEST_CASE("a state of the time before the command ends no skill: it has to change first") {
  for (const char* before : {"0", "2"}) {
    TaskFixture fixture;
    fixture.task(before);
    fixture.execute();
    for (int i = 0; i < 5; ++i) fixture.task(before, 0.15);
    CHECK(fixture.told<Outcome>().empty());
    fixture.task("1", 0.15);
    CHECK(fixture.told<Outcome>().empty());
    fixture.task("0", 0.15);
    CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
    fixture.execute();
    fixture.task("2", 0.15);
    CHECK(fixture.one<Outcome>().outcome == TaskOutcome::failed);
  }
}

TEST_CASE("a change that is heard at once may be of the time before, too") {
  TaskFixture fixture;
  fixture.task("1");
  fixture.execute();
  fixture.task("0", 0.05);
  fixture.task("0", 0.1);
  CHECK(fixture.told<Outcome>().empty());
  fixture.task("1", 0.1);
  fixture.task("0", 2.5);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("a task that is over before its state is seen to change is over when the state has stayed for 2 s") {
  for (const bool once : {false, true}) {
    TaskFixture fixture;
    fixture.task("0");
    fixture.execute();
    fixture.task("0", 0.05);
    for (int i = 0; i < 19; ++i) once ? fixture.wait(0.1) : fixture.task("0", 0.1);
    CHECK(fixture.told<Outcome>().empty());
    fixture.wait(0.06);
    CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
  }
}

TEST_CASE("such a wait is shorter than the time-out, and without any state the skill does not end") {
  TaskFixture fixture;
  fixture.task("0");
  fixture.execute(1);
  fixture.task("0", 0.2);
  fixture.wait(0.29);
  CHECK(fixture.told<Outcome>().empty());
  fixture.wait(0.02);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
  TaskFixture silent;
  silent.task("0");
  silent.execute();
  silent.wait(3);
  CHECK(silent.told<Outcome>().empty());  // it may not have begun
}

TEST_CASE("a critical fault ends the skill that needs what is gone: it is halted, and nobody waits for its time-out") {
  for (const auto& [severity, capability] :
       {std::pair{Severity::critical, "mobile"}, {Severity::warning, "mobile"}, {Severity::critical, "carry"}}) {
    Settings settings = ridgeback();
    settings.description.skills[0].capability = "mobile";
    FaultRule rule;
    rule.value = "error";
    rule.when = FaultWhen::changes;
    rule.severity = severity;
    rule.capability = capability;
    settings.description.faults = {rule};
    settings.commands.requests["error"] = "/error data";
    RosFixture fixture(std::move(settings));
    fixture.bridge(true);
    const auto watched = fixture.asked();
    REQUIRE(watched.size() == 2);
    const auto error = std::ranges::find(watched, "/error", &BridgeCommand::name)->token;
    fixture.tell(error, BridgeResult::value, "\"\"");
    fixture.deliver(MessageType::command, Execute{{"run", "t1", 1, 1}, 1, kInstance, "go_to", R"({"place":"dock"})", 0},
                    "ridgeback");
    fixture.tell(fixture.asked().at(0).token, BridgeResult::done);
    fixture.tell(error, BridgeResult::value, "\"a wheel is blocked\"");
    CHECK(fixture.told<RobotFault>().size() == 1);
    const bool ends = severity == Severity::critical && std::string_view(capability) == "mobile";
    const auto stop = fixture.asked();
    CHECK(stop.size() == (ends ? 2 : 0));  // its stop has two topics
    CHECK(fixture.told<Outcome>().empty());
    if (!ends) continue;
    for (const auto& one : stop) fixture.tell(one.token, BridgeResult::done);
    fixture.wait(0.4);
    fixture.tell(error, BridgeResult::value, "\"a wheel is blocked\"");
    CHECK(fixture.told<Outcome>().empty());
    fixture.wait(0.1);
    fixture.tell(error, BridgeResult::value, "\"a wheel is blocked\"");  // the way to the robot is not lost
    CHECK(fixture.failure() == "a wheel is blocked");
  }
}

TEST_CASE("a skill whose capability a fault has taken is not begun, until the robot says that it is well") {
  Settings settings = ridgeback();
  settings.description.skills[0].capability = "mobile";
  FaultRule rule;
  rule.value = "error";
  rule.when = FaultWhen::changes;
  rule.severity = Severity::critical;
  rule.capability = "mobile";
  settings.description.faults = {rule};
  settings.commands.requests["error"] = "/error data";
  RosFixture fixture(std::move(settings));
  fixture.bridge(true);
  const auto watched = fixture.asked();
  const auto error = std::ranges::find(watched, "/error", &BridgeCommand::name)->token;
  fixture.out.clear();
  std::uint32_t attempt = 0;
  const auto go = [&] {
    const Execute go_to{{"run", "t1", 1, ++attempt}, 1, kInstance, "go_to", R"({"place":"dock"})", 0};
    return fixture.nack_of(fixture.deliver(MessageType::command, go_to, "ridgeback"));
  };
  // Also at the first value, but without a RobotFault: the node may have started after the fault.
  fixture.tell(error, BridgeResult::value, "\"a wheel is blocked\"");
  CHECK(fixture.told<RobotFault>().empty());
  CHECK(fixture.one<NodeProfile>().out_of_use.at(0).text == "a wheel is blocked");
  const Nack refused = go();
  CHECK(refused.code == "out_of_use");
  CHECK(refused.what.find("a wheel is blocked") != std::string::npos);
  CHECK(fixture.asked().empty());
  fixture.tell(error, BridgeResult::value, "\"\"");
  CHECK(fixture.over() == std::vector<std::string>{"mobile: a wheel is blocked"});
  CHECK(go().code.empty());
  CHECK(fixture.asked().size() == 1);
}

namespace {

/// The driver alone: its value() is seen.
struct DriverAlone {
  std::unique_ptr<Driver> made = *make_with<RosDriver, read_ros_commands>(with_error());
  Driver& driver = *made;
  Outbox outbox;
  RobotOutbox robot;
  std::vector<EventFrom> events;
  DriverOut out{&driver, outbox, robot, events};
  Now now{{1'000'000'000}, {}};
  std::uint64_t error = 0;  ///< the newest watch's token

  DriverAlone() { live(0); }
  static DriverSettings with_error() {
    Settings settings = ridgeback();
    settings.instance = kInstance;
    FaultRule rule;
    rule.value = "error";
    rule.when = FaultWhen::changes;
    settings.description.faults = {rule};
    settings.commands.requests["error"] = "/error data";
    return settings;
  }
  /// Time passes, and the bridge lives.
  void live(double time_s) {
    const MonotonicTime end = now.mono + seconds(time_s);
    driver.on_bridge(BridgeState{1, true, ""}, now, out);
    while (driver.next_deadline() && *driver.next_deadline() <= end) {
      now.mono = *driver.next_deadline();
      driver.on_bridge(BridgeState{1, true, ""}, now, out);
      driver.tick(now, out);
    }
    now.mono = end;
  }
  void tell(BridgeResult result, const std::string& data = "", const std::string& code = "") {
    driver.on_bridge(BridgeEvent{kInstance, error, result, data, code, code.empty() ? "" : "why", ""}, now, out);
  }
  /// How often /error was watched since the last call.
  std::size_t watched() {
    std::size_t times = 0;
    for (const BridgeCommand& command : trb::sent<BridgeCommand>(outbox)) {
      if (command.name != "/error" || command.action != BridgeAction::watch) continue;
      error = command.token;
      ++times;
    }
    outbox.sends.clear();
    return times;
  }
};

}  // namespace

TEST_CASE("a watch that the bridge gives up is ordered again, soon at first, and its value counts no more") {
  DriverAlone fixture;
  REQUIRE(fixture.watched() == 1);
  fixture.tell(BridgeResult::value, "\"well\"");
  REQUIRE(fixture.driver.value("error"));
  fixture.tell(BridgeResult::failed, "", "queue_full");
  CHECK_FALSE(fixture.driver.value("error"));
  fixture.live(0.99);
  CHECK(fixture.watched() == 0);
  fixture.live(0.02);
  CHECK(fixture.watched() == 1);
  // A second time after twice as long, at last every half minute.
  fixture.tell(BridgeResult::failed, "", "queue_full");
  fixture.live(1.9);
  CHECK(fixture.watched() == 0);
  fixture.live(0.2);
  CHECK(fixture.watched() == 1);
  for (int i = 0; i < 10; ++i) {
    fixture.tell(BridgeResult::failed, "", "queue_full");
    fixture.live(30.1);
    CHECK(fixture.watched() == 1);
  }
  // With a value it is well again.
  fixture.tell(BridgeResult::value, "\"well\"");
  fixture.tell(BridgeResult::failed, "", "queue_full");
  fixture.live(1.1);
  CHECK(fixture.watched() == 1);
  // With the link it is watched anew at once, and once.
  fixture.tell(BridgeResult::failed, "", "queue_full");
  fixture.driver.on_bridge(BridgeState{2, true, ""}, fixture.now, fixture.out);
  CHECK(fixture.watched() == 1);
  fixture.driver.tick(fixture.now, fixture.out);
  CHECK(fixture.watched() == 0);
}

TEST_CASE("a message that the bridge could not use makes its value unknown, which is logged now and then") {
  DriverAlone fixture;
  REQUIRE(fixture.watched() == 1);
  fixture.tell(BridgeResult::value, "\"well\"");
  fixture.events.clear();
  for (int i = 0; i < 100; ++i) {
    fixture.tell(BridgeResult::value, "", "too_large");
    CHECK_FALSE(fixture.driver.value("error"));
    fixture.live(0.1);
  }
  CHECK(fixture.outbox.logs.size() == 1);
  CHECK(std::ranges::count(fixture.outbox.counts, "refused.bridge") == 100);
  CHECK(fixture.events.empty());  // no fault begins or ends with it
  fixture.live(60);
  fixture.tell(BridgeResult::value, "", "too_large");
  CHECK(fixture.outbox.logs.size() == 2);
  CHECK(fixture.watched() == 0);
  fixture.tell(BridgeResult::value, "\"well\"");
  REQUIRE(fixture.driver.value("error"));
  CHECK(fixture.driver.value("error")->json == "\"well\"");
}

TEST_CASE("a stream's watch that the bridge gives up is ordered again as long as the stream lasts") {
  OnlineRos fixture;
  fixture.send(MessageType::request, "scan", R"({"stream_s": 3, "every_s": 0.5})");
  const auto watch = fixture.asked().at(0);
  REQUIRE(watch.action == BridgeAction::watch);
  fixture.tell(watch.token, BridgeResult::failed, "", "queue_full");
  fixture.wait(1.1);
  auto asked = fixture.asked();
  REQUIRE(asked.size() == 1);
  CHECK(asked[0].action == BridgeAction::watch);
  CHECK(asked[0].name == "/scan");
  fixture.tell(asked[0].token, BridgeResult::failed, "", "queue_full");
  fixture.wait(1);
  fixture.bridge(true);
  fixture.wait(3);
  CHECK(fixture.asked().empty());  // its end comes first
}

TEST_CASE("a request for a stream is answered, and then told again and again until its time is over") {
  OnlineRos fixture;
  const auto id = fixture.send(MessageType::request, "scan", R"({"stream_s": 2, "every_s": 0.5})");
  auto asked = fixture.asked();
  REQUIRE(asked.size() == 2);
  CHECK(asked[0].action == BridgeAction::watch);
  CHECK(asked[1].action == BridgeAction::ask);
  fixture.tell(asked[1].token, BridgeResult::value, "[1]");
  CHECK(fixture.answer(id) == "[1]");
  fixture.told<Opaque>();
  std::vector<std::string> told;
  for (int i = 0; i < 30; ++i) {
    fixture.wait(0.1);
    fixture.tell(asked[0].token, BridgeResult::value, "[" + std::to_string(i) + "]");
    for (const Send& send : fixture.told<Opaque>()) told.push_back(get<Opaque>(send.body).data);
  }
  CHECK(told == std::vector<std::string>{"[4]", "[9]", "[14]"});
  const auto after = fixture.asked();
  REQUIRE(after.size() == 1);
  CHECK(after[0].action == BridgeAction::unwatch);
  CHECK(after[0].token == asked[0].token);
  CHECK(fixture.answer(fixture.send(MessageType::request, "scan", R"({"stream_s": "long"})")) == "nack bad_value");
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
