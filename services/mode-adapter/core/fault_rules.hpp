// The faults of a description: which of the robot's values mean one; each is reported once when it begins.
#pragma once

#include "common/fleet/fault_rule.hpp"
#include "services/mode-adapter/core/drivers.hpp"

namespace trb::adapter {

/// What a new value causes.
struct FaultChanges {
  std::vector<FaultSaid> said;
  std::vector<FaultOver> over;
};

/// condition | not begun          | begun
/// ----------|--------------------|------------------------------------------------
/// met       | begins: reported   | -
/// neither   | -                  | - (back across the limit, but not far enough)
/// over      | reported as over   | ends: reported as over; one that still waits is not reported
///
/// A fault that was reported less than 10 s ago waits for that time to pass, so that a flapping value floods nobody. A
/// change to "", 0, false or null is the end, any other one begins. The first value received is not a change, but
/// counts for standing().
class FaultRules {
 public:
  /// The rules must outlive it.
  explicit FaultRules(const std::vector<FaultRule>& rules);

  /// A value has arrived; its effects are added to `changes`.
  void on_value(std::string_view name, const RobotValue& value, Now now, FaultChanges& changes);
  void tick(Now now, FaultChanges& changes);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;
  /// The fault that takes the capability away now (empty: any), reported or not: CRITICAL or FATAL, by the latest
  /// values.
  [[nodiscard]] const FaultSaid* standing(std::string_view capability) const;
  /// The robot is disconnected: after it comes back its values decide anew.
  void forget_standing();
  /// A person has reported that the capability (empty: each) is repaired: a condition that is met from now on begins
  /// anew.
  void begin_again(std::string_view capability);

 private:
  struct Watched {
    const FaultRule* rule = nullptr;
    bool begun = false;
    std::optional<std::string> last;  ///< for `changes`: the previous value
    std::optional<FaultSaid> waits;
    std::optional<FaultSaid> stands;  ///< by the latest value
    std::optional<MonotonicTime> quiet_until;
  };

  void begin(Watched& watched, const RobotValue& value, Now now, FaultChanges& changes);
  void on_change(Watched& watched, const RobotValue& value, Now now, FaultChanges& changes);

  std::vector<Watched> watched_;
};

}  // namespace trb::adapter
