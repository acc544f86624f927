#include "services/cli/commands/played_waits.hpp"

#include <algorithm>
#include <cstdio>

#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

std::string end_text(const PlayedTask& of) {
  if (of.is_open) return "-";
  return seconds_text(of.end_s) + (of.has_failed ? " failed" : "");
}

constexpr double kShown_s = 0.5;  ///< a hand-over is shorter

std::string holder_text(const std::vector<PlayedTask>& tasks, const PlayedTask& of, const TaskWait& wait) {
  if (!wait.holder) return "";
  const PlayedTask& holder = tasks[*wait.holder];
  if (holder.run != of.run)
    return holder.robot + ", which did " + holder.id + " of run " + std::to_string(holder.run + 1);
  if (holder.id == of.id) return holder.robot + ", which failed at it";
  return wait.is_robot_busy ? holder.robot + ", which did " + holder.id : holder.id;
}

std::string wait_text(const std::vector<PlayedTask>& tasks, const PlayedTask& of, const TaskWait& wait) {
  const std::string holder = holder_text(tasks, of, wait);
  if (wait.more_s < kShown_s) return holder.empty() ? "-" : holder;
  return (holder.empty() ? "" : holder + "; then ") + seconds_text(wait.more_s) + " s for something else";
}

}  // namespace

std::string seconds_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

void print_waits(const std::vector<PlayedTask>& tasks, std::size_t run) {
  std::vector<std::vector<std::string>> rows{{"TASK", "ROBOT", "BEGIN", "END", "WAITED FOR"}};
  const std::vector<TaskWait> waits = waits_of(tasks);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (tasks[i].run != run) continue;
    rows.push_back({(waits[i].is_critical ? "* " : "  ") + tasks[i].id, tasks[i].robot, seconds_text(tasks[i].begin_s),
                    end_text(tasks[i]), wait_text(tasks, tasks[i], waits[i])});
  }
  print(format_table(rows));
}

void print_waits_key(const std::vector<PlayedTask>& tasks) {
  const std::vector<TaskWait> waits = waits_of(tasks);
  const auto is_shown = [](const TaskWait& wait) { return wait.more_s >= kShown_s; };
  const auto is_on_path = [&](const TaskWait& wait) { return wait.is_critical && is_shown(wait); };
  const bool is_of_several = std::ranges::any_of(tasks, [](const PlayedTask& one) { return one.run > 0; });
  print_line(std::string(is_of_several ? "* the runs' critical paths: a run is shorter only if one of these is"
                                       : "* the critical path: the run is shorter only if one of these is") +
             (std::ranges::any_of(waits, is_on_path) ? ", or waits less for something else" : ""));
  if (std::ranges::any_of(waits, is_shown))
    print_line("something else: no task's end, but a result that was not there yet, a sensor's value, a decision");
}

}  // namespace trb::cli
