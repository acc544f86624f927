#include "services/cloud-gateway/core/alarms/alarm_desk.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;

namespace {

constexpr std::int64_t kS = 1'000'000'000;

UtcTime at(std::int64_t s) {
  return {s * kS};
}

Alert alert(const std::string& id, std::int64_t s, const std::string& robot = "ridgeback",
            Severity severity = Severity::critical, const std::string& run = "") {
  Alert out;
  out.id = id;
  out.robot = robot;
  out.run = run;
  out.cause = "robot_fault";
  out.severity = severity;
  out.time = s * kS;
  return out;
}

Alert over(Alert one) {
  one.state = AlertState::closed;
  return one;
}

}  // namespace

TEST_CASE("an alert is acknowledged by the first who does") {
  AlarmDesk desk;
  desk.see({alert("a", 1)}, at(1));
  CHECK(desk.of("a").acknowledged_by.empty());
  CHECK(desk.of("a").priority == 2);
  CHECK(desk.acknowledge("a", "olga", at(2)).ok());
  CHECK(desk.acknowledge("a", "max", at(3)).ok());
  CHECK(desk.of("a").acknowledged_by == "olga");
  CHECK(desk.of("a").acknowledged == at(2));
  CHECK(desk.take_acknowledged().size() == 1);
  CHECK(desk.acknowledge("b", "olga", at(2)).error().code == Errc::unknown_target);
}

TEST_CASE("an alert that gets worse is to be seen anew, one that gets better is not") {
  AlarmDesk desk;
  desk.see({alert("a", 1, "ridgeback", Severity::urgent)}, at(1));
  CHECK(desk.acknowledge("a", "olga", at(2)).ok());
  desk.see({alert("a", 1, "ridgeback", Severity::warning)}, at(3));
  CHECK(desk.of("a").acknowledged_by == "olga");
  desk.see({alert("a", 1, "ridgeback", Severity::fatal)}, at(4));
  CHECK(desk.of("a").acknowledged_by.empty());
  CHECK(desk.of("a").priority == 1);
}

TEST_CASE("what is in no table any more is forgotten, in the store too") {
  AlarmDesk desk;
  desk.see({alert("a", 1)}, at(1));
  CHECK(desk.acknowledge("a", "olga", at(2)).ok());
  desk.take_acknowledged();
  desk.see({}, at(3));
  const auto changes = desk.take_acknowledged();
  REQUIRE(changes.size() == 1);
  CHECK(changes[0].key == "a");
  CHECK_FALSE(changes[0].row);
}

TEST_CASE("a shelved source stays shelved when it alarms again, and comes back by itself") {
  AlarmDesk desk;
  desk.see({alert("a", 1)}, at(1));
  CHECK(desk.shelve("a", "olga", std::chrono::minutes(10), "the wheel is on its way", at(2)).ok());
  desk.see({over(alert("a", 1)), alert("b", 100)}, at(100));
  CHECK(desk.of("b").shelved_by == "olga");
  CHECK(desk.of("b").shelved_until == at(602));
  desk.tick(at(601));
  CHECK(desk.of("b").shelved_by == "olga");
  desk.tick(at(602));
  CHECK(desk.of("b").shelved_by.empty());
  const auto ended = desk.take_ended();
  REQUIRE(ended.size() == 1);
  CHECK(ended[0].why == "the wheel is on its way");
  CHECK(desk.take_shelves().back().row == std::nullopt);
}

TEST_CASE("the clock steps: a shelf made since the start lasts as long as was wished, one of before has its end") {
  AlarmDesk desk;
  desk.see({alert("a", 1), alert("b", 1, "ant")}, at(1));
  desk.replace(std::vector{Shelf{source_of(alert("b", 1, "ant")), "max", at(2), at(900), "why"}});
  CHECK(desk.shelve("a", "olga", std::chrono::minutes(15), "why", at(20)).ok());
  desk.take_shelves();
  desk.move({at(10), at(600), std::chrono::hours(14)});
  CHECK(desk.take_shelves().size() == 1);
  const std::int64_t hours = 14 * 3600;
  desk.tick(at(hours + 601));
  CHECK(desk.of("b").shelved_by.empty());
  CHECK(desk.of("a").shelved == at(hours + 20));
  desk.tick(at(hours + 919));
  CHECK(desk.of("a").shelved_by == "olga");
  desk.tick(at(hours + 920));
  CHECK(desk.of("a").shelved_by.empty());
}

TEST_CASE("a shelf has an end and a reason, and somebody may end it sooner") {
  AlarmDesk desk;
  desk.see({alert("a", 1), alert("other", 1, "ant")}, at(1));
  CHECK(desk.shelve("a", "olga", Duration::zero(), "why", at(2)).error().code == Errc::bad_value);
  CHECK(desk.shelve("a", "olga", std::chrono::hours(9), "why", at(2)).error().code == Errc::bad_value);
  CHECK(desk.shelve("a", "olga", std::chrono::hours(8), "", at(2)).error().code == Errc::bad_value);
  CHECK(desk.shelve("a", "olga", std::chrono::hours(8), std::string(256, 'x'), at(2)).error().code == Errc::bad_value);
  CHECK(desk.unshelve("a").error().code == Errc::conflict);
  CHECK(desk.shelve("a", "olga", std::chrono::hours(8), "why", at(2)).ok());
  CHECK(desk.of("other").shelved_by.empty());
  CHECK(desk.shelve("a", "max", std::chrono::minutes(1), "other", at(3)).ok());
  CHECK(desk.of("a").shelved_by == "max");
  CHECK(desk.of("a").shelved_until == at(63));
  CHECK(desk.unshelve("a").ok());
  CHECK(desk.of("a").shelved_by.empty());
  CHECK(desk.unshelve("nobody").error().code == Errc::unknown_target);
}

TEST_CASE("the number of shelves is bounded") {
  AlarmDesk desk;
  std::vector<Alert> alerts;
  for (std::size_t i = 0; i <= kMaxShelves; ++i) {
    alerts.push_back(alert("a" + std::to_string(i), 1, "robot" + std::to_string(i)));
  }
  desk.see(alerts, at(1));
  for (std::size_t i = 0; i < kMaxShelves; ++i) {
    CHECK(desk.shelve(alerts[i].id, "olga", std::chrono::minutes(1), "why", at(1)).ok());
  }
  CHECK(desk.shelve(alerts.back().id, "olga", std::chrono::minutes(1), "why", at(1)).error().code == Errc::queue_full);
  CHECK(desk.shelve(alerts[0].id, "olga", std::chrono::minutes(2), "why", at(1)).ok());
}

TEST_CASE("an alarm that chatters is said so, and is acknowledged once") {
  AlarmDesk desk;
  std::vector<Alert> alerts;
  for (int i = 0; i < 3; ++i) {
    for (Alert& one : alerts) one = over(one);
    alerts.push_back(alert("a" + std::to_string(i), 10 * i));
    desk.see(alerts, at(10 * i));
  }
  CHECK(desk.of("a2").chatters);
  CHECK(desk.of("a2").times == 3);
  CHECK(desk.acknowledge("a2", "olga", at(21)).ok());
  alerts.back() = over(alerts.back());
  alerts.push_back(alert("a3", 30));
  desk.see(alerts, at(30));
  CHECK(desk.of("a3").times == 4);
  CHECK(desk.of("a3").acknowledged_by == "olga");
  alerts.back() = over(alerts.back());
  alerts.push_back(alert("a4", 40, "ridgeback", Severity::fatal));
  desk.see(alerts, at(40));
  CHECK(desk.of("a4").acknowledged_by.empty());
  desk.see({alert("a9", 1000)}, at(1000));
  CHECK_FALSE(desk.of("a9").chatters);
  CHECK(desk.of("a9").acknowledged_by.empty());
}

TEST_CASE("one fault of a robot that three runs need: three decisions, none of them repeats another") {
  AlarmDesk desk;
  const auto of_run = [](const std::string& id, std::int64_t s, const std::string& run) {
    return alert(id, s, "turtlebot", Severity::critical, run);
  };
  const std::vector<Alert> faults{of_run("a1", 10, "run1"), of_run("a2", 10, "run2"), of_run("a3", 10, "run3")};
  desk.see(faults, at(10));
  for (const Alert& one : faults) {
    CHECK_FALSE(desk.of(one.id).chatters);
    CHECK(desk.of(one.id).times == 1);
  }
  CHECK(desk.acknowledge("a1", "olga", at(11)).ok());
  std::vector<Alert> more = faults;
  more.push_back(of_run("a4", 20, "run4"));
  desk.see(more, at(20));
  CHECK_FALSE(desk.of("a4").chatters);
  CHECK(desk.of("a4").acknowledged_by.empty());
  for (Alert& one : more) one = over(one);
  desk.see(more, at(30));
  CHECK_FALSE(desk.of("a4").chatters);
}

TEST_CASE("a fault that comes again and again in several runs: no open decision of a run is taken for a repeat") {
  AlarmDesk desk;
  std::vector<Alert> alerts;
  for (int i = 0; i < 3; ++i) {
    for (Alert& one : alerts) one = over(one);
    for (const std::string run : {"run1", "run2"}) {
      alerts.push_back(alert(run + "-" + std::to_string(i), 10 * i, "ridgeback", Severity::critical, run));
    }
    desk.see(alerts, at(10 * i));
  }
  CHECK_FALSE(desk.of("run1-2").chatters);
  CHECK(desk.of("run2-2").chatters);
  CHECK(desk.of("run2-2").times == 3);
}

TEST_CASE("the first cause: of a robot, or of a run that loses several at once") {
  AlarmDesk desk;
  desk.see({alert("base", 10), alert("arm", 20), alert("late", 500), alert("ant", 15, "ant")}, at(500));
  CHECK(desk.of("base").first.empty());
  CHECK(desk.of("arm").first == "base");
  CHECK(desk.of("late").first == "base");
  CHECK(desk.of("ant").first.empty());
  desk.see({over(alert("base", 10)), alert("arm", 20), alert("late", 500)}, at(500));
  CHECK(desk.of("arm").first.empty());
  CHECK(desk.of("late").first == "arm");
  desk.see({alert("one", 10, "a", Severity::urgent, "run"), alert("two", 70, "b", Severity::urgent, "run"),
            alert("three", 71, "c", Severity::urgent, "run")},
           at(80));
  CHECK(desk.of("two").first == "one");
  CHECK(desk.of("three").first == "two");
}

TEST_CASE("a restart knows what people did") {
  AlarmDesk desk;
  desk.replace(std::vector{Acknowledgement{"a", "olga", at(2), Severity::critical}});
  desk.replace(std::vector{Shelf{source_of(alert("a", 1)), "max", at(2), at(600), "why"}});
  desk.see({alert("a", 1)}, at(3));
  CHECK(desk.of("a").acknowledged_by == "olga");
  CHECK(desk.of("a").shelved_by == "max");
  CHECK(desk.take_acknowledged().empty());
  CHECK(desk.take_shelves().empty());
}

TEST_CASE("what is in another gateway's table only is kept for a week") {
  const std::int64_t week = kForgottenAfter / std::chrono::seconds(1);
  AlarmDesk desk;
  desk.replace(std::vector{Acknowledgement{"theirs", "olga", at(2), Severity::critical}});
  desk.see({alert("a", 1)}, at(3));
  desk.see({}, at(2 + week));
  CHECK(desk.has({"theirs", "olga", at(2), Severity::critical}));
  CHECK(desk.take_acknowledged().empty());
  desk.see({}, at(3 + week));
  CHECK_FALSE(desk.has({"theirs", "olga", at(2), Severity::critical}));
  CHECK(desk.take_acknowledged().size() == 1);
}

TEST_CASE("what another gateway has stored is taken over, beside own changes that are not stored yet") {
  AlarmDesk desk;
  desk.see({alert("a", 1), alert("b", 1, "ant"), alert("c", 1, "cat")}, at(1));
  REQUIRE(desk.acknowledge("a", "olga", at(2)));
  REQUIRE(desk.shelve("b", "olga", std::chrono::minutes(1), "why", at(2)));
  desk.replace(std::vector{Acknowledgement{"c", "max", at(2), Severity::urgent}});
  desk.replace(std::vector<Shelf>{});
  CHECK(desk.of("a").acknowledged_by == "olga");
  CHECK(desk.of("b").shelved_by == "olga");
  CHECK(desk.of("c").acknowledged_by == "max");
  CHECK_FALSE(desk.has({"c", "olga", at(3), Severity::critical}));
  CHECK(desk.has({"c", "olga", at(3), Severity::warning}));
  REQUIRE(desk.take_acknowledged().size() == 1);
  REQUIRE(desk.take_shelves().size() == 1);
  desk.replace(std::vector<Acknowledgement>{});
  desk.replace(std::vector<Shelf>{});
  CHECK(desk.of("a").acknowledged_by.empty());
  CHECK(desk.of("b").shelved_by.empty());
}
