// The parts of a resilience core, put together by hand: a run of two tasks, whose robots and scheduler the test plays.
#pragma once

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "services/resilience/core/core_parts.hpp"
#include "services/resilience/test/add_task.hpp"
#include "services/resilience/test/fleet_fixture.hpp"

namespace trb::resilience::test {

class Parts : public CoreParts {
 public:
  /// The cloud node decides on run "run1": t1 of r1, running; t2 of r2, waiting. r1, r2 and r3 are there, and each can
  /// do both.
  explicit Parts(Role role = Role::cloud, ResilienceSettings settings = default_resilience())
      : CoreParts({"", role, settings, {{"dock", {0, 0}}}}) {
    situation.on_welcome({"cloud", role, 1}, now);
    begin_run();
    tell_routes();
    detect();
    out = {};
  }

  /// Sends the router's table; `gone` is not reached.
  void tell_routes(const std::string& gone = "") {
    RouteTable table;
    for (const char* id : {"r1", "r2", "r3"}) {
      table.routes.push_back(route_of(id, mobile_robot(), id == gone ? "CONNECTION_BROKEN" : "ONLINE"));
      table.routes.back().certificate.payload.bytes = id;
    }
    situation.receive(table, now, out);
  }

  /// Sends the scheduler's present view.
  void tell_view() { situation.runs().on(view); }

  /// Looks for what is new.
  void detect() { detection.look(now, out); }

  void break_down(const std::string& robot) {
    situation.receive(RobotFault{"mobile", Severity::critical, "a wheel is off"}, robot, now, out);
  }

  /// The task has failed for good, and the run waits for a decision.
  Alert& fail_task(std::size_t task) {
    view.state = RunState::paused;
    view.tasks[task].outcome = TaskOutcome::failed;
    view.tasks[task].attempt = 1;
    tell_view();
    detect();
    REQUIRE(alerts.open().size() == 1);
    return *alerts.open().front();
  }

  void wait(Duration time) { now = {now.mono + time, now.utc + time}; }
  [[nodiscard]] const WatchedRun& run() const { return *situation.runs().find("run1"); }

  /// The messages of that kind since the last call, the oldest first.
  template <class T>
  std::vector<T> take_sent() {
    std::vector<T> found;
    for (const Send& send : out.sends) {
      if (const auto* body = get_if<T>(&send.body)) found.push_back(*body);
    }
    out.sends.clear();
    return found;
  }

  Now now{{1'000'000'000'000}, at_second(0)};
  Outbox out;
  RunView view;

 private:
  void begin_run() {
    RunStart start;
    start.run = "run1";
    Certificate cloud;
    cloud.id = "cloud";
    cloud.role = Role::cloud;
    start.members = {{"cloud", {}}};
    start.members.back().certificate.payload.bytes = encode(cloud);
    view.run = "run1";
    for (const char* id : {"t1", "t2"}) {
      Task task;
      task.id = id;
      task.robot = id[1] == '1' ? "r1" : "r2";
      task.skill = "go_to";
      task.data = R"({"place": "dock"})";
      add_task(std::move(task), start, view);
    }
    view.tasks[0].state = TaskState::running;
    RunSummary summary;
    summary.run = "run1";
    RunTable table;
    table.runs.push_back(summary);
    situation.runs().on(table, now);
    tell_view();
    Definition definition;
    definition.start.payload.bytes = encode(start);
    situation.runs().on(definition);
    REQUIRE(run().is_known());
  }
};

}  // namespace trb::resilience::test
