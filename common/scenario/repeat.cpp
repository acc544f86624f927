#include "common/scenario/repeat.hpp"

#include <algorithm>

#include "common/base/ids.hpp"

namespace trb {
namespace {

constexpr char kRound = '#';

bool is_round(std::string_view text) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  return !text.empty() && text.size() <= 4 && text != "1" && text.front() != '0' &&
         std::all_of(text.begin(), text.end(), is_digit);
}

/// The tasks without a successor.
std::vector<std::uint16_t> last_tasks(const std::vector<Task>& tasks) {
  std::vector<bool> awaited(tasks.size(), false);
  for (const Task& task : tasks) {
    for (const std::uint16_t before : task.after) awaited[before] = true;
  }
  std::vector<std::uint16_t> out;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (!awaited[i]) out.push_back(static_cast<std::uint16_t>(i));
  }
  return out;
}

/// The task in round `round`; `last` are the last tasks of the round before.
Task in_round(Task task, std::uint32_t round, std::size_t tasks, const std::vector<std::uint16_t>& last) {
  const bool first = task.after.empty();
  if (first) task.after = last;
  const std::size_t shift = tasks * (first ? round - 2 : round - 1);
  for (std::uint16_t& before : task.after) before = static_cast<std::uint16_t>(before + shift);
  task.id = round_id(task.id, round);
  for (ValueFrom& value : task.values) value.task = round_id(value.task, round);
  return task;
}

}  // namespace

std::string round_id(const std::string& id, std::uint32_t round) {
  return round < 2 ? id : id + kRound + std::to_string(round);
}

std::string first_id(const std::string& id) {
  return id.substr(0, id.find(kRound));
}

bool is_valid_task_id(std::string_view id) {
  const std::size_t mark = id.find(kRound);
  if (id.size() > kMaxIdSize || !is_valid_id(id.substr(0, mark))) return false;
  return mark == std::string_view::npos || is_round(id.substr(mark + 1));
}

bool is_repetition(std::string_view id) {
  return id.find(kRound) != std::string_view::npos;
}

std::vector<Task> repeat_tasks(const std::vector<Task>& tasks, std::uint32_t rounds) {
  const std::vector<std::uint16_t> last = last_tasks(tasks);
  std::vector<Task> out = tasks;
  out.reserve(tasks.size() * rounds);
  for (std::uint32_t round = 2; round <= rounds; ++round) {
    for (const Task& task : tasks) out.push_back(in_round(task, round, tasks.size(), last));
  }
  return out;
}

}  // namespace trb
