// The mode-adapter's core: messages to the robot and back, skills, stop and release. README.md lists its messages.
#pragma once

#include "common/actor/core.hpp"
#include "common/actor/takes.hpp"
#include "services/mode-adapter/core/fault_injection.hpp"
#include "services/mode-adapter/core/hand_drive.hpp"
#include "services/mode-adapter/core/robot_control.hpp"
#include "services/mode-adapter/core/robot_side.hpp"
#include "services/mode-adapter/core/robot_status.hpp"
#include "services/mode-adapter/core/robot_watch.hpp"
#include "services/mode-adapter/core/skill_desk.hpp"
#include "services/mode-adapter/core/stop_control.hpp"
#include "services/mode-adapter/core/user_messages.hpp"

namespace trb::adapter {

class ModeAdapterCore : public Core {
 public:
  using Taken = Takes<Execute, CancelExecution, ExecutionQuery, OutcomeJournaled, AdapterStateRequest, Stop, Release,
                      TakeOutOfUse, TakeIntoUse, InjectFault, Velocity, BridgeEvent, BridgeState>;

  ModeAdapterCore(Settings settings, PersistFence persist, PersistOutOfUse keep, InjectLine inject = {});

  void on_welcome(const NodeIdentity& node, Now now, Outbox& out) override;
  void on(const Inbound& message, Now now, Outbox& out) override;
  void tick(Now now, Outbox& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

  // Events of the robot's connections. A channel that the core has closed itself is down at once: io does not report
  // it.
  void on_channel_up(Channel channel, Now now, Outbox& out);
  void on_channel_down(Channel channel, const std::string& reason, Now now, Outbox& out);
  void on_bytes(Channel channel, BytesView bytes, Now now, Outbox& out);
  /// What the robot gets of the steps since the last call: to be carried out once their messages are sent.
  [[nodiscard]] RobotOutbox take_robot_output() { return robot_.take_output(); }
  /// The process is told to end: who drives is over, its robot is ordered to stand, and nothing more begins.
  void begin_leave(Now now, Outbox& out);
  /// False while the robot has not taken that order.
  [[nodiscard]] bool may_leave() const { return !hand_.has_to_stand(); }
  /// The process ends: the drivers' last messages.
  void leave(Now now, Outbox& out);

  /// The process is to be replaced, and asks again and again whether it may end: no skill has run, nobody has driven
  /// and no outcome has been owed for kQuiet, and its router was `heard` since then. From the first question on the
  /// scheduler takes the robot for busy, so that it gives nothing more; what it gave before that is still done. An
  /// outcome, and the router, are waited for 30 s at most.
  [[nodiscard]] bool may_be_replaced(MonotonicTime heard, Now now, Outbox& out);

 private:
  /// An order that the scheduler gave before it knew is here by then.
  static constexpr Duration kQuiet = std::chrono::milliseconds(500);
  /// One that was lost on its way, as in a router that was started anew, too, is asked for by then, and given again
  /// within the same time.
  static constexpr Duration kGivenAgain = std::chrono::seconds(3);
  static constexpr Duration kNoRouter = std::chrono::seconds(30);

  [[nodiscard]] static bool begins_something(const Inbound& message);
  void on_other(const Inbound& message, Now now, Outbox& out);
  void execute(const Inbound& message, const Execute& order, Now now, Outbox& out);
  [[nodiscard]] bool at_work(Now now) const;
  template <class Heard>
  void on_bridge(const Inbound& message, const Heard& heard, Now now, Outbox& out);
  [[nodiscard]] Condition condition() const;

  // handles the drivers' events
  void settle(Now now, Outbox& out);
  void on_event(Driver& mode, const DriverEvent& event, Now now, Outbox& out);
  void on_progress(Token token, const char* state, Now now, Outbox& out);
  void on_said(Driver& mode, const Said& said, Now now, Outbox& out);
  void on_values(Driver& mode, Now now, Outbox& out);
  void on_link_up(Driver& mode, Now now, Outbox& out);
  void on_link_down(Driver& mode, const std::string& reason, Now now, Outbox& out);

  RobotSide robot_;
  RobotStatus status_;
  StopControl stops_;
  SkillDesk desk_;
  RobotFaults faults_;
  RobotWatch watch_;
  FaultInjection injection_;
  RobotControl control_;
  HandDrive hand_;
  UserMessages messages_;
  bool leaving_ = false;
  bool to_be_replaced_ = false;
  MonotonicTime welcomed_;
  std::optional<MonotonicTime> quiet_since_;    ///< while it is to be replaced and not at work
  std::optional<MonotonicTime> expects_until_;  ///< while it is: the scheduler has asked for an attempt unknown here
};

}  // namespace trb::adapter
