// What this node waits for in a run: values of sensors, signatures, answers, times. A restart forgets it; it follows
// again from the facts.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/scheduler/core/run/awaited_records.hpp"
#include "services/scheduler/core/run/inquiry.hpp"
#include "services/scheduler/core/run/signature.hpp"
#include "services/scheduler/core/run/task_timers.hpp"
#include "services/scheduler/core/run/withheld_tasks.hpp"

namespace trb::scheduler {

class PendingWork {
 public:
  [[nodiscard]] const std::vector<Inquiry>& inquiries() const { return inquiries_; }
  /// For the conditions that this node has to evaluate.
  [[nodiscard]] std::vector<Inquiry>& inquiries() { return inquiries_; }
  [[nodiscard]] const PendingSignatures& signatures() const { return signatures_; }
  [[nodiscard]] PendingSignatures& signatures() { return signatures_; }
  [[nodiscard]] const AwaitedRecords& awaited() const { return awaited_; }
  [[nodiscard]] AwaitedRecords& awaited() { return awaited_; }
  [[nodiscard]] const TaskTimers& timers() const { return timers_; }
  [[nodiscard]] TaskTimers& timers() { return timers_; }
  [[nodiscard]] const WithheldTasks& withheld() const { return withheld_; }
  [[nodiscard]] WithheldTasks& withheld() { return withheld_; }

  /// A decision has ruled on the task: it begins anew.
  void begin_anew(TaskIndex task);
  /// Nothing of it is waited for: no value, no signature, no result.
  [[nodiscard]] bool is_empty() const;

  /// This node's robot begins a task of it.
  void note_served(MonotonicTime now) { served_ = now; }
  [[nodiscard]] std::optional<MonotonicTime> served() const { return served_; }
  /// Since it is over it goes to the archive after `grace`; true once that has come.
  bool may_leave(MonotonicTime now, Duration grace);
  void stay() { leaves_at_.reset(); }

  /// The result of its attempt was signed, and the run does not believe the signature: it stays without one.
  void give_up_attempt() { given_up_attempt_ = true; }
  [[nodiscard]] bool has_given_up_attempt() const { return given_up_attempt_; }

  /// A member that waits for AbortConfirmed.
  void note_abort_from(const std::string& member) { confirm_to_.insert(member); }
  std::set<std::string> take_unconfirmed() { return std::exchange(confirm_to_, {}); }

  /// The service has come back to its router: what was asked may be lost.
  void restart(Now now);
  /// But for tasks that are due.
  [[nodiscard]] std::optional<MonotonicTime> next() const;

 private:
  std::vector<Inquiry> inquiries_;
  PendingSignatures signatures_;
  AwaitedRecords awaited_;
  TaskTimers timers_;
  WithheldTasks withheld_;
  std::optional<MonotonicTime> served_;
  std::optional<MonotonicTime> leaves_at_;
  std::set<std::string> confirm_to_;
  bool given_up_attempt_ = false;
};

}  // namespace trb::scheduler
