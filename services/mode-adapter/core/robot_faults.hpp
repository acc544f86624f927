// The robot's faults, and what keeps it out of use: as reported by itself, its values, persons and the node's services.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/mode-adapter/core/fault_rules.hpp"
#include "services/mode-adapter/core/out_of_use_book.hpp"
#include "services/mode-adapter/core/robot_side.hpp"
#include "services/mode-adapter/core/skill_desk.hpp"

namespace trb::adapter {

class RobotFaults {
 public:
  RobotFaults(RobotSide& robot, SkillDesk& desk, PersistOutOfUse keep);

  // ---- reports of the robot
  void on_fault(const FaultSaid& fault, Now now, Outbox& out);
  void on_over(const FaultOver& over, Now now, Outbox& out);
  /// Applies the description's rules to all values of the driver.
  void on_values(const Driver& mode, Now now, Outbox& out);
  void on_value(std::string_view name, const RobotValue& value, Now now, Outbox& out);
  /// The connection is lost: new values are judged anew.
  void on_link_down() { rules_.forget_standing(); }

  // ---- orders of persons and services
  void on_take_out(const Inbound& message, const TakeOutOfUse& order, Now now, Outbox& out);
  void on_take_in(const Inbound& message, const TakeIntoUse& order, Outbox& out);

  /// Why the skill cannot begin; nothing: its capability is in use.
  [[nodiscard]] std::optional<Error> refusal(const Execute& order) const;
  /// Why what needs the capability is refused; nothing: it is in use.
  [[nodiscard]] std::optional<Error> refusal(const std::string& capability) const;
  /// As in the profile.
  [[nodiscard]] const std::vector<OutOfUse>& shown() const { return book_.shown(); }

  /// Writes what is not on disk yet.
  void save(Now now, Outbox& out) { book_.tick(now, out); }
  /// Reports the faults whose time has come.
  void tick(Now now, Outbox& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  [[nodiscard]] std::optional<Error> refusal(const std::string& capability, const FaultSaid* standing) const;
  void keep(const FaultSaid& fault, Now now, Outbox& out);
  void notify(const FaultChanges& changes, Now now, Outbox& out);
  void notify_end(const OutOfUse& ended, const std::string& text, Outbox& out);
  [[nodiscard]] Status may_take_out(const Inbound& message, const OutOfUse& what) const;
  Status returned(const TakeIntoUse& order, Outbox& out);
  Status repaired(const TakeIntoUse& order, Outbox& out);
  [[nodiscard]] std::vector<std::string> concerned(const std::string& capability) const;
  [[nodiscard]] bool knows_capability(const std::string& capability) const;

  RobotSide& robot_;
  SkillDesk& desk_;
  FaultRules rules_;
  OutOfUseBook book_;
};

}  // namespace trb::adapter
