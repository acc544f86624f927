// Who may command the robot now: nobody while it is fenced, else the holder of the lease or whoever takes it over.
#pragma once

#include "common/actor/outbox.hpp"
#include "services/mode-adapter/core/control_lease.hpp"
#include "services/mode-adapter/core/drivers.hpp"
#include "services/mode-adapter/core/stop_control.hpp"

namespace trb::adapter {

class RobotControl {
 public:
  /// `robot`: the node's id, for the hints. `stops` outlives it.
  RobotControl(const StopControl& stops, std::string robot) : stops_(stops), robot_(std::move(robot)) {}

  /// Why a command of `by` is refused. Errors: fenced; control_held, unless it takes the control over.
  [[nodiscard]] std::optional<Error> barred(const Holder& by, bool take, Now now) const;
  /// A command of `by` is accepted. A takeover is counted and logged.
  void take(const Holder& by, Now now, Outbox& out);
  /// The last command of a person has started something: its lease lasts while that runs.
  void began(const Driver& mode, Token token) { commanded_ = {&mode, token}; }
  /// Frees the lease when its holder's command is over. `skill_runs`: a task of a run is under way; `driven`: its
  /// holder drives the robot by hand.
  void refresh(bool skill_runs, bool driven, Now now);
  /// The holder lets go of the robot.
  void give_up(const Holder& by) { lease_.free(by); }

  [[nodiscard]] bool fenced() const { return stops_.fenced(); }
  [[nodiscard]] const std::optional<Holder>& holder() const { return lease_.holder(); }
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return lease_.next_deadline(); }

 private:
  struct Commanded {
    const Driver* mode = nullptr;
    Token token = 0;
  };

  const StopControl& stops_;
  std::string robot_;
  ControlLease lease_;
  Commanded commanded_;
};

}  // namespace trb::adapter
