// The mode-adapter's core: messages to the robot and back, skills, stop and release. README.md says what it hears and
// says.
#pragma once

#include "common/actor/core.hpp"
#include "common/actor/takes.hpp"
#include "services/mode-adapter/core/control_lease.hpp"
#include "services/mode-adapter/core/fault_injection.hpp"
#include "services/mode-adapter/core/pending_requests.hpp"
#include "services/mode-adapter/core/robot_side.hpp"
#include "services/mode-adapter/core/robot_status.hpp"
#include "services/mode-adapter/core/robot_watch.hpp"
#include "services/mode-adapter/core/skill_desk.hpp"
#include "services/mode-adapter/core/stop_control.hpp"
#include "services/mode-adapter/core/streams.hpp"

namespace trb::adapter {

class ModeAdapterCore : public Core {
 public:
  using Taken = Takes<Execute, CancelExecution, ExecutionQuery, OutcomeJournaled, AdapterStateRequest, Stop, Release,
                      TakeOutOfUse, TakeIntoUse, InjectFault, BridgeEvent, BridgeState>;

  ModeAdapterCore(Settings settings, PersistFence persist, PersistOutOfUse keep, InjectLine inject = {});

  void on_welcome(const NodeIdentity& node, Now now, Outbox& out) override;
  void on(const Inbound& message, Now now, Outbox& out) override;
  void tick(Now now, Outbox& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

  // What io hears of the robot. A channel that the core has closed itself is down at once: io does not say so again.
  void on_channel_up(Channel channel, Now now, Outbox& out);
  void on_channel_down(Channel channel, const std::string& reason, Now now, Outbox& out);
  void on_bytes(Channel channel, BytesView bytes, Now now, Outbox& out);
  /// The process ends.
  void leave(Now now, Outbox& out);

  /// True while no skill runs, so that the process may be replaced.
  [[nodiscard]] bool idle() const { return !desk_.busy(); }

 private:
  // messages for the robot: to_robot.cpp
  void on_other(const Inbound& message, Now now, Outbox& out);
  void on_opaque(const Inbound& message, const Opaque& body, Now now, Outbox& out);
  void on_command(const Inbound& message, const Opaque& body, Now now, Outbox& out);
  void on_request(const Inbound& message, const Opaque& body, Now now, Outbox& out);
  bool begin_stream(const Inbound& message, const Opaque& body, Driver& mode, Now now, Outbox& out);
  void end_streams(Now now, Outbox& out);
  void answer_from_monitor(const Inbound& message, const Opaque& body, Driver& mode, Now now, Outbox& out);
  void on_nack(const Inbound& message, const Nack& nack, Now now, Outbox& out);
  void inform(std::string_view subtype, std::string_view source, BytesView data, Now now, Outbox& out);
  /// The message's token; none: refused, and told so.
  std::optional<Token> wait_or_answer(PendingRequests& pending, const Inbound& message, const Opaque& body,
                                      Driver& mode, Now now, Outbox& out);

  template <class Heard>
  void on_bridge(const Inbound& message, const Heard& heard, Now now, Outbox& out);

  // who may command it: control.cpp
  void execute(const Inbound& message, const Execute& order, Now now, Outbox& out);
  [[nodiscard]] std::optional<Error> barred(const Holder& by, bool take, Now now) const;
  void take_control(const Holder& by, Now now, Outbox& out);
  void refresh_control(Now now);
  [[nodiscard]] Condition condition() const;
  [[nodiscard]] Error explain(const Error& error, std::string_view subtype) const;

  // events of the modes: from_robot.cpp
  void settle(Now now, Outbox& out);
  void on_event(Driver& mode, const DriverEvent& event, Now now, Outbox& out);
  void on_progress(Token token, const char* state, Now now, Outbox& out);
  void on_refused(const Refused& refused, Now now, Outbox& out);
  void on_said(Driver& mode, const Said& said, Now now, Outbox& out);
  void on_link_up(Driver& mode, Now now, Outbox& out);
  void on_link_down(Driver& mode, const std::string& reason, Now now, Outbox& out);
  void expire(PendingRequests& pending, const char* what, Now now, Outbox& out);

  RobotSide robot_;
  RobotStatus status_;
  StopControl stops_;
  SkillDesk desk_;
  RobotFaults faults_;
  RobotWatch watch_;
  FaultInjection injection_;
  ControlLease control_;
  struct {
    Driver* mode = nullptr;
    Token token = 0;
  } commanded_;               ///< the last command that a person has given
  PendingRequests commands_;  ///< until the robot has them
  PendingRequests requests_;  ///< until the robot has answered them
  Streams streams_;           ///< requests that go on
};

}  // namespace trb::adapter
