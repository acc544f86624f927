// The faults of a description: which of the robot's values means one, told once when it begins.
#pragma once

#include "common/fleet/fault_rule.hpp"
#include "services/mode-adapter/core/drivers.hpp"

namespace trb::adapter {

/// What the values of one moment lead to.
struct FaultChanges {
  std::vector<FaultSaid> said;
  std::vector<FaultOver> over;
};

/// condition | not begun          | begun
/// ----------|--------------------|------------------------------------------------
/// met       | begins: told       | -
/// neither   | -                  | - (a limit is passed back, but not by far enough)
/// over      | told to be over    | ends: told to be over; one that still waits to be told is not told
///
/// A fault that was told less than 10 s ago waits for that time to pass, so that a value which flaps floods nobody. A
/// change to "", 0, false or null is the end, any other one begins. The first value heard is nothing changed, but it
/// stands.
class FaultRules {
 public:
  /// The rules must outlive it.
  explicit FaultRules(const std::vector<FaultRule>& rules);

  /// A value was heard; what it leads to is added to `changes`.
  void on_value(std::string_view name, const RobotValue& value, Now now, FaultChanges& changes);
  void tick(Now now, FaultChanges& changes);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;
  /// The fault that takes the capability (empty: any) now, told or not: CRITICAL or FATAL, by the value that was heard
  /// last.
  [[nodiscard]] const FaultSaid* standing(std::string_view capability) const;
  /// The robot has left: what it comes back with, its values tell.
  void forget_standing();
  /// A person has said that the capability (empty: each) is whole: what is met from now on begins anew.
  void begin_again(std::string_view capability);

 private:
  struct Watched {
    const FaultRule* rule = nullptr;
    bool begun = false;
    std::optional<std::string> last;  ///< of a change: the value before
    std::optional<FaultSaid> waits;
    std::optional<FaultSaid> stands;  ///< by the value heard last
    std::optional<MonotonicTime> quiet_until;
  };

  void begin(Watched& watched, const RobotValue& value, Now now, FaultChanges& changes);
  void on_change(Watched& watched, const RobotValue& value, Now now, FaultChanges& changes);

  std::vector<Watched> watched_;
};

}  // namespace trb::adapter
