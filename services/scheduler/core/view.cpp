#include "services/scheduler/core/view.hpp"

#include <algorithm>

#include "common/scenario/condition.hpp"
#include "proto/message.hpp"
#include "proto/value.hpp"

namespace trb::scheduler {
namespace {

std::string trouble_text(const Run& run, TaskIndex task) {
  const TaskResult& result = run.results().of(task)->result;
  const std::string where = "task '" + result.key.task + "' ";
  const std::string why = result.reason.empty() ? std::string("no reason given") : result.reason;
  if (run.results().finished_twice(task)) {
    return "a person: " + where + "has two different results on '" + result.robot + "' (double_execution)";
  }
  if (result.outcome == TaskOutcome::interrupted) {
    return "a person has to decide: " + where + "was interrupted on '" + result.robot + "': " + why;
  }
  if (result.outcome == TaskOutcome::released) {
    return "a decision: " + where + "was given back by '" + result.robot + "'";
  }
  return where + (result.outcome == TaskOutcome::failed ? "failed" : "is retriable") + " on '" + result.robot +
         "': " + why;
}

std::string held_text(const Run& run) {
  const PauseOrder& order = *run.pause();
  return "a person: held by '" + order.by + "'" + (order.reason.empty() ? "" : ": " + order.reason) +
         "; trb scenario resume lets it go on";
}

/// The first task that waits for a robot to be chosen.
std::optional<TaskIndex> first_unbound(const Run& run) {
  for (std::size_t i = 0; i < run.tasks().size(); ++i) {
    if (run.wants_robot(static_cast<TaskIndex>(i))) return static_cast<TaskIndex>(i);
  }
  return std::nullopt;
}

/// Choosing takes a moment; what takes longer waits for a robot to come.
bool lacks_robot(const Run& run, UtcTime now) {
  constexpr Duration kChoosing = std::chrono::seconds(10);
  const auto task = first_unbound(run);
  return task && now >= UtcTime{run.results().of(*task)->result.ended} + kChoosing;
}

std::string unbound_text(const Run& run) {
  const auto task = first_unbound(run);
  if (!task) return {};
  return "a robot for task '" + run.tasks()[*task].id + "', to be chosen by '" + run.decider() +
         "'; see: trb alert list";
}

std::string abort_text(const Run& run, const Executor& executor) {
  std::string out;
  if (executor.runs(run.id())) out = "task '" + executor.attempt()->execute.key.task + "' to stop here";
  const auto members = run.duties.creditors(DutyKind::abort);
  if (members.empty()) return out;
  out += (out.empty() ? "" : "; ") + std::string("the confirmation of");
  for (std::size_t i = 0; i < members.size(); ++i) out += (i == 0 ? " '" : ", '") + members[i] + "'";
  return out;
}

std::string robot_text(const Run& run, const Executor& executor) {
  if (executor.attempt()) {
    const Attempt& attempt = *executor.attempt();
    if (!executor.runs(run.id()) || attempt.phase != Phase::refused) return {};
    return "task '" + attempt.execute.key.task + "': " + executor.obstacle();
  }
  for (const TaskIndex task : run.startable()) {
    const std::string obstacle = executor.obstacle();
    if (!obstacle.empty()) return "task '" + run.tasks()[task].id + "': " + obstacle;
  }
  return {};
}

/// What a condition waits for, that is evaluated here or by whoever has told.
std::string condition_obstacle(const Run& run) {
  for (const Inquiry& inquiry : run.inquiries) {
    if (!inquiry.obstacle().empty()) return inquiry.obstacle();
  }
  for (const auto& [task, told] : run.waits) {
    if (!told.empty()) return told;
  }
  return {};
}

/// When everything that stands before the task was final.
UtcTime due_since(const Run& run, TaskIndex task) {
  std::int64_t out = run.start().created;
  for (const TaskIndex before : run.tasks()[task].after) {
    out = std::max(out, run.results().of(before)->result.ended);
  }
  return UtcTime{out};
}

/// A task that could begin, and of which nothing is heard: who has to pass it on may be gone as well as who has to do
/// it. Only the decider holds every result and is told of every beginning.
std::string handover_text(const Run& run, UtcTime now) {
  constexpr Duration kUsual = std::chrono::seconds(10);
  const std::vector<std::string> clouds = run.clouds();
  if (std::find(clouds.begin(), clouds.end(), run.decider()) != clouds.end()) return {};
  for (std::size_t i = 0; i < run.tasks().size(); ++i) {
    const auto task = static_cast<TaskIndex>(i);
    const auto& after = run.tasks()[task].after;
    const bool due = run.current(task) == nullptr && run.robot_of(task) != run.decider() &&
                     std::all_of(after.begin(), after.end(), [&](TaskIndex is) { return run.results().has_final(is); });
    if (!due || run.progress.contains(task) || now < due_since(run, task) + kUsual) continue;
    const std::string name = "task '" + run.tasks()[task].id + "'";
    const bool chooses = run.is_conditional(task) && run.choice_on(task) == nullptr;
    if (chooses) return "'" + run.chooser_of(task) + "' to evaluate the condition of " + name;
    const std::string& giver = after.empty() ? run.start().submitter : run.robot_of(after.back());
    return "'" + run.robot_of(task) + "' to begin " + name + ", passed on by '" + giver + "'";
  }
  return {};
}

std::string condition_of(const Run& run, TaskIndex task) {
  if (!run.is_conditional(task)) return {};
  const Condition& condition = run.tasks()[task].when.front();
  const HeldChoice* held = run.choice_on(task);
  if (held == nullptr) return condition_text(condition);
  return verdict_text(condition, held->choice.node, held->choice.reading);
}

TaskState state_by_outcome(TaskOutcome outcome) {
  switch (outcome) {
    case TaskOutcome::finished:
      return TaskState::finished;
    case TaskOutcome::skipped:
      return TaskState::skipped;
    case TaskOutcome::failed:
      return TaskState::failed;
    case TaskOutcome::retriable:
    case TaskOutcome::interrupted:
      return TaskState::retriable;
    case TaskOutcome::none:
    case TaskOutcome::released:
      break;
  }
  return TaskState::waiting;
}

/// What a baton has said of a task.
struct Known {
  bool is_final = false;
  bool skipped = false;
};

/// The state of a task whose result is not held.
TaskState open_state(const Run& run, const Executor& executor, TaskIndex task, Known known) {
  if (executor.runs(run.id()) && executor.attempt()->execute.key.task == run.tasks()[task].id) {
    return executor.attempt()->phase == Phase::running ? TaskState::running : TaskState::initializing;
  }
  if (known.is_final) return known.skipped ? TaskState::skipped : TaskState::finished;
  const auto told = run.progress.find(task);
  return told == run.progress.end() ? TaskState::waiting : told->second;
}

TaskView task_view(const Run& run, const Executor& executor, TaskIndex task, Known known) {
  const Task& is = run.tasks()[task];
  TaskView view;
  view.id = is.id;
  if (!run.is_unbound(task)) view.robot = run.robot_of(task);
  view.skill = is.skill;
  view.after = is.after;
  view.condition = condition_of(run, task);
  // A task comes from no robot if the decider's node has held it.
  if (run.is_ruled(task) && run.robot_before(task) != run.decider()) view.moved_from = run.robot_before(task);
  const HeldResult* held = run.current(task);
  if (held == nullptr) {
    view.state = open_state(run, executor, task, known);
    view.attempt = run.results().of(task) == nullptr ? 0 : run.next_attempt(task);
    return view;
  }
  const TaskResult& result = held->result;
  view.state = state_by_outcome(result.outcome);
  view.outcome = result.outcome;
  view.reason = result.reason;
  view.attempt = result.key.attempt;
  view.started = result.started;
  view.ended = result.ended;
  view.duration_s = result.duration_s;
  return view;
}

}  // namespace

RunState state_of(const Run& run, const Executor& executor, UtcTime now) {
  if (run.aborted()) {
    const bool open = executor.runs(run.id()) || !run.duties.creditors(DutyKind::abort).empty();
    return open ? RunState::aborting : RunState::aborted;
  }
  const bool trouble = run.held() || !run.troubles().empty();
  if (run.all_final() && !trouble) return RunState::finished;
  if (run.expired(now)) return RunState::expired;
  return trouble || lacks_robot(run, now) ? RunState::paused : RunState::running;
}

std::string waits_for(const Run& run, const Executor& executor, UtcTime now) {
  std::string out;
  switch (state_of(run, executor, now)) {
    case RunState::aborting:
      out = abort_text(run, executor);
      break;
    case RunState::paused:
      out = !run.troubles().empty() ? trouble_text(run, run.troubles().front())
            : run.held()            ? held_text(run)
                                    : unbound_text(run);
      break;
    case RunState::running:
      out = robot_text(run, executor);
      if (out.empty()) out = condition_obstacle(run);
      if (out.empty()) out = unbound_text(run);
      if (out.empty()) out = handover_text(run, now);
      break;
    case RunState::finished:
    case RunState::aborted:
    case RunState::expired:
      break;
  }
  return out.substr(0, 1024);
}

void fit(RunView& view) {
  constexpr std::size_t kMost = kMaxDataSize - 1024;
  for (const std::size_t kept : {128U, 0U}) {
    if (encode(view).size() <= kMost) return;
    for (TaskView& task : view.tasks) {
      task.reason = cut_utf8(task.reason, kept);
      task.condition = cut_utf8(task.condition, kept);
    }
  }
  const std::size_t decisions = view.decisions.size();
  for (const std::size_t oldest : {decisions / 2, decisions}) {
    if (encode(view).size() <= kMost) return;
    for (std::size_t i = 0; i < oldest; ++i) view.decisions[i].tasks.clear();
  }
}

RunView view_of(const Run& run, const Executor& executor, UtcTime now) {
  RunView view;
  view.run = run.id();
  view.name = run.start().scenario.name;
  view.state = state_of(run, executor, now);
  view.waits_for = waits_for(run, executor, now);
  view.epoch = run.epoch();
  view.submitter = run.start().submitter;
  view.created = run.start().created;
  view.expires = run.start().expires;
  for (std::size_t i = 0; i < run.decisions().size(); ++i) {
    const Decision& by = run.decisions()[i];
    view.decisions.push_back({by.epoch, by.by, by.alert, by.person, by.reason, by.time, by.tasks});
  }
  if (run.pause() != nullptr) view.pause_number = run.pause()->number;
  if (run.held()) view.paused_by = run.pause()->by;
  const std::vector<bool> known = run.known_final();
  const std::vector<bool> skipped = run.known_skipped();
  for (std::size_t i = 0; i < run.tasks().size(); ++i) {
    view.tasks.push_back(task_view(run, executor, static_cast<TaskIndex>(i), {known[i], skipped[i]}));
  }
  fit(view);
  return view;
}

RunSummary summary_of(const Run& run, const Executor& executor, UtcTime now) {
  RunSummary summary;
  summary.run = run.id();
  summary.name = run.start().scenario.name;
  summary.state = state_of(run, executor, now);
  summary.waits_for = waits_for(run, executor, now);
  summary.created = run.start().created;
  summary.tasks = static_cast<std::uint32_t>(run.tasks().size());
  const std::vector<bool> known = run.known_final();
  summary.epoch = run.epoch();
  summary.version = run.version();
  summary.tasks_final = static_cast<std::uint32_t>(std::count(known.begin(), known.end(), true));
  return summary;
}

}  // namespace trb::scheduler
