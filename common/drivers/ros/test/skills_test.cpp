// When a skill of a robot on ROS ends: by the topics that are watched, and by faults.
#include <algorithm>

#include "common/drivers/ros/driver.hpp"
#include "common/drivers/ros/test/fixture.hpp"
#include "common/drivers/vendor_faults.hpp"

using namespace trb;
using namespace trb::adapter;

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
