// The faults of a description: which of the robot's values means one, told once when it begins.
#pragma once

#include "common/fleet/fault_rule.hpp"
#include "services/mode-adapter/core/modes/mode.hpp"

namespace trb::adapter {

/// condition | not begun          | begun
/// ----------|--------------------|------------------------------------------------
/// met       | begins: told       | -
/// neither   | -                  | - (a limit is passed back, but not by far enough)
/// over      | -                  | ends; one that still waits to be told is not told
///
/// A fault that was told less than 10 s ago waits for that time to pass, so that a value which flaps floods nobody. A
/// change has no end: each one begins. The first value heard is nothing changed, and "", 0, false and null are no
/// fault.
class FaultRules {
 public:
  /// The rules must outlive it.
  explicit FaultRules(const std::vector<FaultRule>& rules);

  /// News of a value; what begins now is added to `told`.
  void on_value(std::string_view name, const RobotValue& value, Now now, std::vector<FaultSaid>& told);
  void tick(Now now, std::vector<FaultSaid>& told);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;
  /// The fault that takes the capability now, told or not: CRITICAL or FATAL, by the value that was heard last.
  [[nodiscard]] const FaultSaid* standing(std::string_view capability) const;
  /// The robot has left: what it comes back with, its values tell.
  void forget_standing();

 private:
  struct Watched {
    const FaultRule* rule = nullptr;
    bool begun = false;
    std::optional<std::string> last;  ///< of a change: the value before
    std::optional<FaultSaid> waits;
    std::optional<FaultSaid> stands;  ///< by the value heard last
    std::optional<MonotonicTime> quiet_until;
  };

  void begin(Watched& watched, const RobotValue& value, Now now, std::vector<FaultSaid>& told);
  void on_change(Watched& watched, const RobotValue& value, Now now, std::vector<FaultSaid>& told);

  std::vector<Watched> watched_;
};

}  // namespace trb::adapter
