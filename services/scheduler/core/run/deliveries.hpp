// What this node owes to the other members of a run: it follows from the facts, minus what they have confirmed.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "services/scheduler/core/run/facts.hpp"
#include "services/scheduler/core/run/members.hpp"
#include "services/scheduler/core/run/pending_deliveries.hpp"

namespace trb::scheduler {

class Deliveries {
 public:
  /// All must outlive it.
  Deliveries(const RunDefinition& definition, const Members& members, const Epochs& epochs, const Facts& facts)
      : definition_(definition), members_(members), epochs_(epochs), facts_(facts) {}
  Deliveries(const Deliveries&) = delete;
  Deliveries& operator=(const Deliveries&) = delete;

  [[nodiscard]] const PendingDeliveries& pending() const { return pending_; }
  [[nodiscard]] PendingDeliveries& pending() { return pending_; }

  /// The run was submitted here: this node passes on the tasks that wait for nothing.
  void note_submitted() { submitted_here_ = true; }
  [[nodiscard]] bool submitted_here() const { return submitted_here_; }
  /// To the actors of the tasks that wait for nothing, and to the cloud, so that it knows the run.
  void owe_first_batons();
  /// A result of this node, or that a task was done twice, which its judge may not know: to the cloud, or to the
  /// submitter if there is none.
  void owe_result(TaskIndex task);
  /// A robot that was replaced had finished after all: whoever took its task over need not begin it.
  void owe_late_result(TaskIndex task);
  /// The batons that a task's being final makes due.
  void owe_batons_after(TaskIndex task);
  /// For a new epoch, in which the old ones mean nothing.
  void owe_batons_anew();
  void owe_batons(const std::vector<TaskIndex>& tasks);
  /// To every other member.
  void owe_to_members(DeliveryKind kind);

  /// Another node has journaled it; false if it was not owed.
  bool settle(DeliveryKind kind, const std::string& to, const std::vector<TaskIndex>& tasks) {
    return pending_.settle(kind, to, tasks);
  }
  /// In which epoch tasks' batons were journaled there.
  void note_passed(const std::vector<TaskIndex>& tasks, const std::string& to, std::uint32_t epoch);
  /// Its baton was journaled in this epoch by whom it goes to.
  [[nodiscard]] bool has_passed(TaskIndex task) const;
  /// Tasks that nobody is known to have passed on, though the decider, this node, holds every result before them.
  [[nodiscard]] std::vector<TaskIndex> unpassed() const;

  /// That node has said whether it understands short forms: it may have another version since.
  void note_reads_short(const std::string& node, bool reads);
  [[nodiscard]] bool reads_short(const std::string& node) const { return short_readers_.contains(node); }

  /// Who does not take its baton, and why.
  void note_refusal(const std::string& node, const std::string& why) { refusals_[node] = why; }
  void forget_refusal(const std::string& node) { refusals_.erase(node); }
  [[nodiscard]] const std::map<std::string, std::string>& refusals() const { return refusals_; }

 private:
  /// To whom a task goes from here: who evaluates its condition, if that is not known to have happened, then its robot.
  [[nodiscard]] const std::string& next_actor(TaskIndex task) const;
  [[nodiscard]] bool is_ready_after(TaskIndex next, TaskIndex task) const;
  [[nodiscard]] bool gives(TaskIndex task) const;
  [[nodiscard]] bool decider_gives(TaskIndex task) const;

  const RunDefinition& definition_;
  const Members& members_;
  const Epochs& epochs_;
  const Facts& facts_;
  PendingDeliveries pending_;
  bool submitted_here_ = false;
  std::map<std::pair<TaskIndex, std::string>, std::uint32_t> passed_;
  std::map<std::string, std::string> refusals_;
  std::set<std::string> short_readers_;
};

}  // namespace trb::scheduler
