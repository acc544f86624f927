// What is watched of a robot on ROS: what the bridge gives up is ordered again, what it could not use is unknown.
#include <algorithm>
#include <memory>

#include "common/drivers/ros/driver.hpp"
#include "common/drivers/ros/test/fixture.hpp"
#include "common/drivers/vendor_faults.hpp"

using namespace trb;
using namespace trb::adapter;

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

TEST_CASE("a value with a part that the robot has not measured is unknown, until it is measured again") {
  DriverAlone fixture;
  REQUIRE(fixture.watched() == 1);
  for (const char* const unknown : {"null", "[null,1.0]"}) {
    fixture.tell(BridgeResult::value, "2");
    REQUIRE(fixture.driver.value("error"));
    fixture.tell(BridgeResult::value, unknown);
    CHECK_FALSE(fixture.driver.value("error"));
  }
  fixture.tell(BridgeResult::value, "[1.0,2.0]");
  REQUIRE(fixture.driver.value("error"));
  CHECK(fixture.driver.value("error")->numbers == std::vector{1.0, 2.0});
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
