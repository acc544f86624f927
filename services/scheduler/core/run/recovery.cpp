#include "services/scheduler/core/run/recovery.hpp"

#include <algorithm>

namespace trb::scheduler {
namespace {

/// As often in vain takes 3 s.
constexpr unsigned kAskedInVain = 5;
/// And this takes 1.4 s: an order that came with a refusal may have been lost.
constexpr unsigned kRefusals = 4;

}  // namespace

void Recovery::note_told(const std::string& member) {
  told_.insert(member);
  ++changes_;
  asked_.erase(member);
}

void Recovery::note_first_pass() {
  is_first_passed_ = true;
  ++changes_;
}

std::vector<std::string> Recovery::silent(const std::vector<std::string>& members, const std::string& self) const {
  std::vector<std::string> out;
  std::ranges::copy_if(members, std::back_inserter(out),
                       [&](const std::string& one) { return one != self && !told_.contains(one); });
  return out;
}

std::vector<Recovery::Question> Recovery::take_due(const std::vector<std::string>& silent, std::size_t tasks,
                                                   MonotonicTime now) {
  std::vector<Question> out;
  for (const std::string& member : silent) {
    Asked& asked = asked_[member];
    if (!asked.timer.is_due(now)) continue;
    asked.timer.on_sent(now);
    if (asked.timer.times() == kAskedInVain) ++changes_;
    Question question{member, !asked.has_decisions, {}};
    for (std::size_t i = 0; i < tasks && asked.has_decisions; ++i) {
      const auto task = static_cast<TaskIndex>(i);
      if (!asked.results.contains(task)) question.tasks.push_back(task);
    }
    out.push_back(std::move(question));
  }
  return out;
}

/// Asks it at once for what it has not told.
void Recovery::note_answer(Asked& asked) {
  if (asked.timer.times() >= kAskedInVain) ++changes_;
  asked.timer.restart();
}

void Recovery::note_decisions(const std::string& member) {
  Asked& asked = asked_[member];
  if (!asked.has_decisions) note_answer(asked);
  asked.has_decisions = true;
}

bool Recovery::note_results(const std::string& member, const std::vector<TaskIndex>& tasks, std::size_t of_tasks) {
  Asked& asked = asked_[member];
  // Its results may be of an epoch whose decision is not known yet.
  if (!asked.has_decisions) return false;
  const std::size_t before = asked.results.size();
  asked.results.insert(tasks.begin(), tasks.end());
  // More at once only for what is new: nobody keeps this node asking without a pause.
  if (asked.results.size() > before) note_answer(asked);
  return tasks.empty() || asked.results.size() >= of_tasks;
}

bool Recovery::is_away(const std::string& member) const {
  const auto asked = asked_.find(member);
  return asked != asked_.end() && asked->second.timer.times() >= kAskedInVain;
}

bool Recovery::note_over(const std::string& member) {
  Asked& asked = asked_[member];
  if (!asked.has_decisions) {
    note_decisions(member);
    return false;
  }
  return ++asked.refusals >= kRefusals;
}

bool Recovery::is_stuck(const std::vector<std::string>& silent) const {
  return std::ranges::any_of(silent, [&](const std::string& member) { return is_away(member); });
}

bool Recovery::are_away(const std::vector<std::string>& silent) const {
  return std::ranges::all_of(silent, [&](const std::string& member) { return is_away(member); });
}

std::optional<MonotonicTime> Recovery::next(const std::vector<std::string>& silent) const {
  std::optional<MonotonicTime> out;
  for (const std::string& member : silent) {
    const auto asked = asked_.find(member);
    out = earlier(out, asked == asked_.end() ? MonotonicTime{} : asked->second.timer.due_at());
  }
  return out;
}

std::string recovery_text(const std::vector<std::string>& silent, bool is_first_passed) {
  constexpr std::size_t kNamed = 3;
  std::string who;
  for (std::size_t i = 0; i < silent.size() && i < kNamed; ++i) who += (i == 0 ? "'" : ", '") + silent[i] + "'";
  if (silent.size() > kNamed) who += " and " + std::to_string(silent.size() - kNamed) + " more";
  const char* why = is_first_passed ? "a journal was lost here, and the clocks do not show that the run is younger "
                                      "(compare them: trb doctor)"
                                    : "this node's journal does not have the run";
  return who + " to tell what was decided and done: " + why +
         "; start who is off, revoke who is gone for good (trb fleet revoke), or abort the run";
}

}  // namespace trb::scheduler
