// The users' own messages: to the robot and from it, and which senders wait for an answer.
#pragma once

#include "services/mode-adapter/core/robot_control.hpp"
#include "services/mode-adapter/core/robot_side.hpp"
#include "services/mode-adapter/core/streams.hpp"
#include "services/mode-adapter/core/waiting_senders.hpp"

namespace trb::adapter {

/// message     | its sender is answered
/// ------------|-----------------------------------------------------------------------------------
/// command     | once the robot has it or begins it (Ack), refuses it, or has not accepted it in time
/// request     | with the robot's answer, or with the value of its monitor
/// information | never; it is not given to the robot if it is named as one of its commands
class UserMessages {
 public:
  /// Both outlive it.
  UserMessages(RobotSide& robot, RobotControl& control) : robot_(robot), control_(control) {}

  void on_message(const Inbound& message, const Opaque& body, Now now, Outbox& out);
  /// A message of the robot could not be delivered.
  void on_nack(const Inbound& message, const Nack& nack, Now now, Outbox& out);

  // events of the modes
  void on_progress(Token token, const char* state, Outbox& out);
  void on_refused(const Refused& refused, Outbox& out);
  void on_said(const Said& said, Outbox& out);
  void on_values(Driver& mode, Now now, Outbox& out) { streams_.on_values(mode, now, out); }
  void on_link_down(Driver& mode, const std::string& reason, Outbox& out);

  void tick(Now now, Outbox& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  void on_information(const Inbound& message, const Opaque& body, Now now, Outbox& out);
  [[nodiscard]] bool means_command(std::string_view subtype) const;
  void on_command(const Inbound& message, const Opaque& body, Now now, Outbox& out);
  void on_request(const Inbound& message, const Opaque& body, Now now, Outbox& out);
  bool make_room(const Inbound& message, Now now, Outbox& out);
  bool begin_stream(const Inbound& message, const Opaque& body, Driver& mode, Now now, Outbox& out);
  void answer_from_monitor(const Inbound& message, const Opaque& body, Driver& mode, Now now, Outbox& out);
  void inform(std::string_view subtype, std::string_view source, BytesView data, Now now, Outbox& out);
  /// The message's token; none: refused, and its sender notified.
  std::optional<Token> wait_or_answer(WaitingSenders& waiting, const Inbound& message, const Opaque& body, Driver& mode,
                                      Now now, Outbox& out);
  [[nodiscard]] Error explain(const Error& error, MessageType type, std::string_view subtype) const;
  void expire(WaitingSenders& waiting, const char* what, Now now, Outbox& out);

  RobotSide& robot_;
  RobotControl& control_;
  WaitingSenders commands_;  ///< until the robot has them
  WaitingSenders requests_;  ///< until the robot has answered them
  Streams streams_;          ///< requests with a stream
};

}  // namespace trb::adapter
