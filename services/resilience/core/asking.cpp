// ResilienceCore: a verdict on tasks of which no alert tells: a person wants it otherwise.
#include <algorithm>

#include "proto/value.hpp"
#include "services/resilience/core/resilience_core.hpp"

namespace trb::resilience {
namespace {

constexpr const char* kTrbRun = "trb scenario list names the runs, trb scenario watch a run's tasks";

bool has(const std::vector<std::string>& words, const std::string& word) {
  return std::ranges::find(words, word) != words.end();
}

/// The robot of all of them.
Result<std::string> robot_of(const WatchedRun& run, const std::vector<std::string>& tasks) {
  std::string robot;
  for (const std::string& id : tasks) {
    const auto index = run.find_task(id);
    if (!index) return fail(Errc::bad_value, "tasks: the run has no task '" + cut_utf8(id, 64) + "'", kTrbRun);
    const TaskView& task = run.view->tasks[*index];
    if (is_final(task)) {
      return fail(Errc::conflict, "task '" + id + "' is " + std::string(name_of(task.state)) + " already", kTrbRun);
    }
    if (task.robot.empty()) {
      return fail(Errc::conflict, "task '" + id + "' names no robot yet", "an alert asks for one when it is due");
    }
    if (!robot.empty() && robot != task.robot) {
      return fail(Errc::bad_value, "tasks: '" + id + "' is of " + task.robot + ", others are of " + robot,
                  "decide on one robot's tasks at a time");
    }
    robot = task.robot;
  }
  return robot;
}

}  // namespace

/// By a unique beginning of its id.
Result<const WatchedRun*> ResilienceCore::choose_run(const std::string& beginning) const {
  const WatchedRun* out = nullptr;
  for (const auto& [id, run] : watcher_.runs()) {
    if (!id.starts_with(beginning)) continue;
    if (out != nullptr)
      return fail(Errc::bad_value, "'" + beginning + "' is the beginning of several runs", "give more of the id");
    out = &run;
  }
  if (out != nullptr && out->is_known() && routes_heard_) return out;
  return fail(Errc::unknown_run, "run '" + beginning + "' is not known by this node's scheduler now", kTrbRun);
}

/// The open alert that tells of these tasks. Error: it tells of some of them only.
Result<Alert*> ResilienceCore::alert_of_tasks(const WatchedRun& run, const std::vector<std::string>& tasks) {
  for (Alert* alert : book_.open()) {
    if (alert->run != run.summary.run || !may_be_ruled(*alert)) continue;
    const auto told = std::ranges::count_if(tasks, [&](const std::string& id) { return has(alert->tasks, id); });
    if (told == 0) continue;
    if (static_cast<std::size_t>(told) == tasks.size()) return alert;
    return fail(Errc::conflict, "tasks: alert " + alert->id + " tells of some of them",
                "decide on those by themselves");
  }
  return static_cast<Alert*>(nullptr);
}

Result<std::string> ResilienceCore::decide_tasks(const AlertDecide& body, Now now, Outbox& out) {
  const auto run = choose_run(body.run);
  if (!run) return run.error();
  if (body.tasks.empty()) return fail(Errc::missing, "tasks: which tasks of the run?", "--task T[,T]");
  const auto robot = robot_of(**run, body.tasks);
  if (!robot) return robot.error();
  const auto told = alert_of_tasks(**run, body.tasks);
  if (!told) return told.error();
  if (*told != nullptr) return decide_alert(**told, body, now, out);
  Alert alert = alert_of(**run, *robot, now);
  alert.cause = kAsked;
  alert.text = cut_utf8("asked by '" + body.person + "'" + (body.reason.empty() ? "" : ": " + body.reason), 1024);
  for (const std::string& id : body.tasks) {
    if (!has(alert.tasks, id)) alert.tasks.push_back(id);
  }
  return decide_anew(std::move(alert), body, now, out);
}

/// An alert that is decided as it is raised, or is none.
Result<std::string> ResilienceCore::decide_anew(Alert fresh, const AlertDecide& body, Now now, Outbox& out) {
  Alert* alert = raise(std::move(fresh), now, out);
  if (alert == nullptr) return fail(Errc::queue_full, "too many alerts are open", "decide on some: trb alert list");
  auto decided = decide(*alert, body, now, out);
  if (decided) return decided;
  works_.erase(alert->id);
  book_.drop(alert->id);
  return decided;
}

}  // namespace trb::resilience
