// Whether a decision may make a run's next epoch. An election would be checked here, by the run's decision rule.
#pragma once

#include "services/scheduler/core/run/facts.hpp"
#include "services/scheduler/core/run/members.hpp"

namespace trb::scheduler {

class DecisionChecks {
 public:
  /// All must outlive it.
  DecisionChecks(const RunDefinition& definition, const Members& members, const Epochs& epochs,
                 Certificates& certificates)
      : definition_(definition), members_(members), epochs_(epochs), certificates_(certificates) {}

  /// The decision that makes the next epoch. Errors: not_permitted, conflict (of another epoch, or not built on the
  /// decision before), bad_value, duplicate, too_large and those of open_record and Members::open_new.
  [[nodiscard]] Result<Decision> decision(const SignedRecord& record) const;
  /// Of a decision that has passed, by what this node knows: that nothing it rules on is final by now, and that what is
  /// said to have been given up has been. Only its decider can tell. Error: conflict.
  [[nodiscard]] Status grounds(const Decision& decision, const Facts& facts) const;

 private:
  [[nodiscard]] Status check_author(const SignedRecord& record) const;
  [[nodiscard]] Status check_place(const Decision& decision) const;
  [[nodiscard]] Status check_size(const SignedRecord& record) const;
  [[nodiscard]] Status check_rulings(const Decision& decision) const;
  [[nodiscard]] Status check_ruling(const Decision& decision, const TaskRuling& ruling) const;
  [[nodiscard]] Status check_attempt(TaskIndex task, const TaskRuling& ruling) const;
  [[nodiscard]] Status check_robot(TaskIndex task, const TaskRuling& ruling, bool is_robot) const;
  [[nodiscard]] Status check_ground(const TaskRuling& ruling, const Facts& facts) const;
  [[nodiscard]] std::string name() const { return "run " + definition_.id() + ": decision: "; }
  [[nodiscard]] std::string name_of_task(const TaskRuling& ruling) const {
    return name() + "task '" + ruling.task + "'";
  }

  const RunDefinition& definition_;
  const Members& members_;
  const Epochs& epochs_;
  Certificates& certificates_;
};

}  // namespace trb::scheduler
