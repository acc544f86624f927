#include "common/operator/preflight.hpp"

#include <algorithm>
#include <map>
#include <memory>

#include "common/operator/read_sensor.hpp"
#include "common/operator/routes.hpp"
#include "common/operator/scenario_check.hpp"
#include "common/scenario/condition.hpp"

namespace trb::op {
namespace {

constexpr Duration kPatience = std::chrono::seconds(3);
constexpr double kReading_s = 2;

/// What is being collected; the last answer ends it.
struct Collected {
  Preflight result;
  Callback<Preflight> done;
  std::size_t awaited = 1;  ///< one for whoever sends the requests

  void on_answer() {
    if (--awaited == 0) done(std::move(result));
  }
};
using Collecting = std::shared_ptr<Collected>;

const Route* find_route(const RouteTable& table, const std::string& id) {
  const auto at = std::ranges::find(table.routes, id, &Route::id);
  return at == table.routes.end() ? nullptr : &*at;
}

/// The robots that tasks have from the beginning.
std::vector<RobotPreflight> robots_of(const RunPlan& plan) {
  std::map<std::string, RobotPreflight> by_id;
  for (std::size_t i = 0; i < plan.robots.size(); ++i) {
    const Task& task = plan.scenario.tasks[i];
    const bool is_chosen_later = task.robot.empty() && plan.robots[i] == plan.binder.node;
    if (is_chosen_later) continue;
    RobotPreflight& robot = by_id[plan.robots[i]];
    robot.robot = plan.robots[i];
    robot.tasks.push_back(task.id);
  }
  std::vector<RobotPreflight> out;
  out.reserve(by_id.size());
  for (auto& [id, robot] : by_id) out.push_back(std::move(robot));
  return out;
}

bool is_connected(const NodeProfile& profile) {
  return profile.robot == "ONLINE";
}

/// A value that the robot sends on request; its charge if its description names one, or names none.
std::string question_for(const NodeProfile& profile) {
  for (const char* word : {"battery", "state_of_charge", "position"}) {
    if (std::ranges::find(profile.sensors, word) != profile.sensors.end()) return word;
  }
  return profile.sensors.empty() ? "battery" : profile.sensors.front();
}

/// It says no: it has no such value, or does not send it now. It is there nevertheless.
bool is_refusal(Errc code) {
  return code == Errc::unknown_subtype || code == Errc::bad_value || code == Errc::robot_error || code == Errc::busy;
}

void on_robot_answer(Session& session, RobotPreflight& robot, MonotonicTime sent, const Result<Message>& answer) {
  if (!answer && !is_refusal(answer.error().code)) {
    robot.why.push_back("it does not answer: " + answer.error().what);
    return;
  }
  robot.answers = true;
  robot.answer = answer ? answer->data : answer.error().what;
  robot.answer_ms = std::chrono::duration<double, std::milli>(session.now().mono - sent).count();
}

/// A robot that is stopped, or at work, answers like any other.
void ask_robot(Session& session, const Collecting& collecting, std::size_t index, const Route& route) {
  RobotPreflight& robot = collecting->result.robots[index];
  robot.value = question_for(route.profile);
  robot.asked = is_reached(route) && is_connected(route.profile);
  if (!robot.asked) return;
  ++collecting->awaited;
  session.request(
      Send{.type = MessageType::request, .target = robot.robot, .body = Opaque{robot.value, ""}},
      [&session, collecting, index, sent = session.now().mono](const Result<Message>& answer) {
        on_robot_answer(session, collecting->result.robots[index], sent, answer);
        collecting->on_answer();
      },
      kPatience);
}

void on_reading(SensorPreflight& sensor, const Result<SensorReading>& reading) {
  if (!reading) {
    sensor.why = reading.error().what;
    return;
  }
  sensor.reading = *reading;
  if (Status good = believe(sensor.condition, *reading); !good) sensor.why = good.error().what;
}

void ask_sensor(Session& session, const Collecting& collecting, std::size_t index, const RouteTable& table) {
  SensorPreflight& sensor = collecting->result.sensors[index];
  const Condition& condition = sensor.condition;
  const auto found = find_sensor(table, {condition.sensor, condition.of, condition.identity});
  if (!found) {
    sensor.why = found.error().what;
    return;
  }
  sensor.node = found->node;
  ++collecting->awaited;
  read_sensor(session, *found, kReading_s, kPatience, [collecting, index](const Result<SensorReading>& reading) {
    on_reading(collecting->result.sensors[index], reading);
    collecting->on_answer();
  });
}

void ask_all(Session& session, const RunPlan& plan, const Collecting& collecting) {
  Preflight& result = collecting->result;
  for (std::size_t i = 0; i < result.robots.size(); ++i) {
    const Route* route = find_route(plan.table, result.robots[i].robot);
    if (route == nullptr) continue;  // impossible: the plan took it from this table
    result.robots[i].why = why_not_ready(*route);
    ask_robot(session, collecting, i, *route);
  }
  for (const Task& task : plan.scenario.tasks) {
    for (const Condition& condition : task.when) result.sensors.push_back({task.id, condition});
  }
  for (std::size_t i = 0; i < result.sensors.size(); ++i) ask_sensor(session, collecting, i, plan.table);
}

}  // namespace

bool Preflight::is_ready() const {
  return faults_that_stop(faults).empty() &&
         std::ranges::all_of(robots, [](const RobotPreflight& one) { return one.why.empty(); }) &&
         std::ranges::all_of(sensors, [](const SensorPreflight& one) { return one.why.empty(); });
}

std::vector<std::string> why_not_ready(const Route& route) {
  if (!is_reached(route)) return {"its node is " + route.state};
  const NodeProfile& profile = route.profile;
  std::vector<std::string> out;
  if (!is_connected(profile)) {
    out.push_back("it is " + profile.robot + (profile.detail.empty() ? "" : ": " + profile.detail));
  }
  if (profile.fenced) out.push_back("it is stopped until it is released");
  if (!profile.control.empty()) out.push_back("it is commanded by " + profile.control);
  for (const OutOfUse& one : profile.out_of_use) {
    const bool counts = one.retired || one.severity >= Severity::critical;
    const std::string what = one.capability.empty() ? "it is" : "its " + one.capability + " is";
    if (counts) out.push_back(what + " out of use: " + one.text);
  }
  return out;
}

void preflight(Session& session, Scenario scenario, std::string file, const Callback<Preflight>& done) {
  plan_run(session, std::move(scenario), std::move(file),
           on_success<RunPlan>(done, [&session, done](const RunPlan& plan) {
             const auto collecting = std::make_shared<Collected>();
             collecting->done = done;
             collecting->result.faults = plan.faults;
             if (faults_that_stop(plan.faults).empty()) {
               const Profiles profiles = profiles_of(plan.table);
               CandidateIndex candidates(profiles);
               collecting->result.without_spare = tasks_without_spare(plan.scenario, candidates);
               collecting->result.robots = robots_of(plan);
               ask_all(session, plan, collecting);
             }
             collecting->on_answer();
           }));
}

}  // namespace trb::op
