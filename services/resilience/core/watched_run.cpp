#include "services/resilience/core/watched_run.hpp"

#include <algorithm>
#include <utility>

#include "common/scenario/decision_rule.hpp"
#include "proto/body.hpp"

namespace trb::resilience {

// The own scheduler checked the certificates before it accepted the run.
std::string WatchedRun::decider() const {
  return start ? first_cloud_of(start->members) : std::string();
}

// The summary comes before the view that shows what was recovered.
bool WatchedRun::recovers() const {
  return summary.recovers || (view && view->recovers);
}

bool WatchedRun::is_member(std::string_view node) const {
  const auto names = [&](const std::vector<Member>& members) {
    return std::ranges::any_of(members, [&](const Member& member) { return member.id == node; });
  };
  if (start && names(start->members)) return true;
  return std::ranges::any_of(decisions, [&](const Decision& decision) { return names(decision.members); });
}

// The own scheduler checked the certificates before it accepted the run.
void WatchedRun::learn_certificates() {
  certificates.clear();
  const auto learn = [&](const std::vector<Member>& members) {
    for (const Member& member : members) {
      auto certificate = decode<Certificate>(member.certificate.payload.bytes);
      if (certificate) certificates.emplace(member.id, std::move(*certificate));
    }
  };
  learn(start->members);
  for (const Decision& decision : decisions) learn(decision.members);
}

std::optional<std::size_t> WatchedRun::find_task(std::string_view id) const {
  if (!view) return std::nullopt;
  const auto at = std::ranges::find(view->tasks, id, &TaskView::id);
  if (at == view->tasks.end()) return std::nullopt;
  return static_cast<std::size_t>(at - view->tasks.begin());
}

std::uint32_t WatchedRun::first_attempt(std::size_t task) const {
  std::uint32_t out = 1;
  for (const DecisionView& decision : view->decisions) {
    for (const TaskRuling& ruling : decision.tasks) {
      if (ruling.task == view->tasks[task].id) out = std::max(out, ruling.attempt);
    }
  }
  return out;
}

std::uint32_t WatchedRun::last_attempt(std::size_t task) const {
  return std::max(first_attempt(task), view->tasks[task].attempt);
}

std::uint32_t WatchedRun::last_possible_attempt(std::size_t task) const {
  const std::uint32_t with_retries = std::min(first_attempt(task) + start->scenario.tasks[task].retries, kMaxAttempts);
  return std::max(last_attempt(task), with_retries);
}

std::uint32_t WatchedRun::policy_moves(std::size_t task) const {
  bool bound = !start->scenario.tasks[task].robot.empty();
  std::uint32_t out = 0;
  for (const DecisionView& decision : view->decisions) {
    for (const TaskRuling& ruling : decision.tasks) {
      if (ruling.task != view->tasks[task].id || ruling.ruling != Ruling::move) continue;
      if (std::exchange(bound, true) && decision.person.empty()) ++out;
    }
  }
  return out;
}

bool WatchedRun::has_stopped(std::size_t index) const {
  const TaskView& task = view->tasks[index];
  const bool ended = task.outcome == TaskOutcome::failed || task.outcome == TaskOutcome::retriable ||
                     task.outcome == TaskOutcome::interrupted || task.outcome == TaskOutcome::released;
  // The result of an attempt that a decision has replaced does not count.
  return ended && task.attempt >= last_attempt(index);
}

bool is_over(RunState state) {
  return state != RunState::running && state != RunState::paused;
}

bool is_final(const TaskView& task) {
  return task.state == TaskState::finished || task.state == TaskState::skipped ||
         task.outcome == TaskOutcome::finished || task.outcome == TaskOutcome::skipped;
}

}  // namespace trb::resilience
