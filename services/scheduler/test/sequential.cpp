#include "services/scheduler/test/sequential.hpp"

#include <algorithm>
#include <optional>

namespace trb::scheduler::test {
namespace {

struct Interpreter {
  const World& world;
  std::vector<Ended> ended;
  std::vector<std::string> results;

  [[nodiscard]] bool holds(const Condition& condition) const {
    const Sense& sense = world.senses.at(condition.sensor);
    if (condition.is_text) return (sense.text == condition.text) == (condition.op == Comparison::equal);
    const double is = sense.number;
    const double than = condition.number;
    const bool verdicts[] = {is<than, is <= than, is> than, is >= than, is == than, is != than};
    return verdicts[static_cast<std::size_t>(condition.op)];
  }

  /// The text of a value that an earlier task told; none: there is no such value.
  [[nodiscard]] std::optional<std::string> value(const Task& task, const ValueFrom& from) const {
    for (const TaskIndex before : task.after) {
      if (world.scenario.tasks[before].id != from.task) continue;
      const std::string& result = results[before];
      if (ended[before].state != TaskState::finished || result.empty()) return std::nullopt;
      if (from.name.empty()) return result;
      if (from.name != "n" || result.front() != '{') return std::nullopt;
      return result.substr(5, result.size() - 6);  // {"n":VALUE}
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<std::string> data(const Task& task) const {
    if (task.values.empty()) return task.data;
    std::string inner = task.data.empty() ? "" : task.data.substr(1, task.data.size() - 2);
    for (const ValueFrom& from : task.values) {
      const auto text = value(task, from);
      if (!text) return std::nullopt;
      inner += (inner.empty() ? "\"" : ",\"") + from.parameter + "\":" + *text;
    }
    return "{" + inner + "}";
  }

  /// How an attempt ends, by the robot that has the task; `failed`, too, if a value is not there.
  TaskOutcome attempt(const Task& task, const std::string& robot, Ended& out, std::string& result) {
    const auto with = data(task);
    if (!with) return TaskOutcome::failed;
    const AttemptKey key{"", task.id, 1, out.attempt};
    out.commands[out.attempt] = {robot, *with};
    const TaskOutcome outcome = world.ending(key);
    if (outcome == TaskOutcome::finished) result = world.told(key, *with);
    return outcome;
  }

  void execute(const Task& task, Ended& out, std::string& result) {
    const bool bound_late = task.robot.empty();
    std::string robot = bound_late ? world.bindings.at(task.id) : task.robot;
    out.attempt = bound_late ? 2 : 1;
    std::uint32_t first = out.attempt;  // that this robot made, or a decision gave it
    for (std::size_t stood = 0;; ++out.attempt) {
      const TaskOutcome outcome = attempt(task, robot, out, result);
      const bool commanded = out.commands.contains(out.attempt);
      const bool repeatable = outcome != TaskOutcome::interrupted || world.repeatable;
      const bool again = commanded && repeatable && out.attempt - first < task.retries;
      out.state = outcome == TaskOutcome::finished ? TaskState::finished : TaskState::failed;
      if (outcome == TaskOutcome::finished) return;
      if (again) continue;
      if (outcome != TaskOutcome::failed) out.state = TaskState::retriable;
      const bool ends = outcome == TaskOutcome::failed || outcome == TaskOutcome::interrupted;
      out.goes_on = ends && task.on_failure == OnFailure::continue_;
      if (out.goes_on || (ends && task.on_failure == OnFailure::skip)) out.state = TaskState::skipped;
      out.aborts = ends && task.on_failure == OnFailure::abort;
      out.holds = !out.aborts && out.state != TaskState::skipped && !world.decides;
      if (out.aborts || out.holds || out.state == TaskState::skipped) return;
      first = out.attempt + 1;
      const TaskRuling ruling = world.ruling(task.id, stood++, robot, first);
      robot = ruling.robot;
      if (ruling.ruling != Ruling::skip) continue;
      out.state = TaskState::skipped;
      out.goes_on = task.on_failure == OnFailure::continue_;
      out.attempt = first;
      return;
    }
  }

  void run(const Task& task, Ended& out, std::string& result) {
    out.reached = true;
    const auto skipped = [&](TaskIndex before) {
      return ended[before].state == TaskState::skipped && !ended[before].goes_on;
    };
    const bool nothing_came = !task.after.empty() && std::all_of(task.after.begin(), task.after.end(), skipped);
    const bool goes = !nothing_came && (task.when.empty() || holds(task.when[0]));
    if (goes) return execute(task, out, result);
    out.state = TaskState::skipped;
  }
};

}  // namespace

std::vector<Ended> interpret(const World& world) {
  const auto& tasks = world.scenario.tasks;
  Interpreter all{world, std::vector<Ended>(tasks.size()), std::vector<std::string>(tasks.size())};
  const auto is_final = [&](TaskIndex before) { return all.ended[before].is_final(); };
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      const auto& after = tasks[i].after;
      if (all.ended[i].reached || !std::all_of(after.begin(), after.end(), is_final)) continue;
      all.run(tasks[i], all.ended[i], all.results[i]);
      goes_on = true;
    }
  }
  return all.ended;
}

}  // namespace trb::scheduler::test
