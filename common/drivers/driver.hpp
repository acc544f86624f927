// A mode: how messages are translated into the robot's language. The core knows a robot only through this interface; a
// mode answers with events, never by calling back.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "common/actor/outbox.hpp"
#include "common/base/time.hpp"
#include "common/drivers/robot_outbox.hpp"
#include "proto/bodies/bridge.hpp"
#include "proto/bodies/robot.hpp"

namespace trb::drivers {

/// Names one message on its way to the robot, or one stop or release sent to it; never reused by a process.
using Token = std::uint64_t;

/// A message for the robot. A mode that keeps the texts copies them.
struct Handover {
  Token token = 0;
  MessageType type = MessageType::none;
  std::string_view subtype;
  std::string_view source;
  BytesView data;
  std::string_view skill;  ///< its name, if the end of this command is waited for
  double patience_s = 0;   ///< its sender waits no longer; 0: there is no such bound
};

/// How far a message has come when hand_over() returns.
enum class Progress : std::uint8_t { queued, handed_over };

// What a mode reports about the robot.
struct HandedOver {
  Token token = 0;
};
struct Started {  ///< the robot reports that it carries the command out
  Token token = 0;
};
struct Ended {  ///< a command with a skill's name is over
  Token token = 0;
  bool well = false;
  std::string text;  ///< the result, or the reason of the failure
};
struct Halted {  ///< of halt(): the command moves the robot no more
  Token token = 0;
  bool well = true;    ///< false: the robot does not take the halt, and its motion goes on
  std::string text{};  ///< why not
};
struct Refused {  ///< the message does not reach the robot, or the robot refuses it
  Token token = 0;
  Error error;
};
struct Said {  ///< a message of the robot's own
  MessageType type = MessageType::none;
  std::string subtype;
  std::string target;
  Bytes data;
};
struct FaultSaid {
  std::string capability;  ///< empty: the whole robot
  Severity severity{};
  std::string text;
  std::string cause{};  ///< what the robot's end of it refers to, as FaultOver names it; empty: the robot reports no
                        ///< end
  bool lasts = true;    ///< the robot reports it as long as it lasts; false: it reported it once
  bool is_new = true;   ///< false: the fleet knows of it under another cause, or from an earlier process
};
struct FaultOver {  ///< reported with every state in which it is over; usually there was no fault
  std::string cause;
};
struct ValuesHeard {};  ///< value() has changed
struct Stopped {        ///< every stop up to this ticket is confirmed
  Token ticket = 0;
  bool by_robot = true;  ///< false: the robot cannot confirm, it was only sent the order
  bool stood = false;    ///< it stood when it was told, and shows no more than that: it need not have the stop
};
struct NotStopped {  ///< the robot refuses every stop up to this ticket; its motion may go on
  Token ticket = 0;
  Error error;
};
struct Released {
  Token ticket = 0;
};
struct LinkUp {};
struct LinkDown {
  std::string reason;
};
using DriverEvent = std::variant<HandedOver, Started, Ended, Halted, Refused, Said, FaultSaid, FaultOver, ValuesHeard,
                                 Stopped, NotStopped, Released, LinkUp, LinkDown>;

class Driver;
struct EventFrom {
  Driver* mode = nullptr;
  DriverEvent event;
};

/// Collects what a mode wants done and what it reports.
struct DriverOut {
  Driver* mode;
  Outbox& out;         ///< for the own node and the fleet
  RobotOutbox& robot;  ///< for the robot
  std::vector<EventFrom>& events;

  void emit(DriverEvent event) const { events.push_back({mode, std::move(event)}); }
  /// Counted as refused.REASON and logged.
  void refuse(std::string_view reason, std::string text) const {
    out.count("refused." + std::string(reason));
    out.log(LogLevel::warning, std::string(reason), std::move(text));
  }
};

/// The robot's last value of a name.
struct RobotValue {
  std::vector<double> numbers;
  std::string json;
  MonotonicTime heard;
};
using RobotValues = std::map<std::string, RobotValue, std::less<>>;

/// The value of that name, or nullptr.
inline const RobotValue* find_value(const RobotValues& values, std::string_view name) {
  const auto found = values.find(name);
  return found == values.end() ? nullptr : &found->second;
}

/// After so long the system itself reports a TCP connection as lost that takes nothing any more (io/tcp.cpp: 5 s).
constexpr Duration kTcpSilence = std::chrono::seconds(6);

class Driver {
 public:
  Driver() = default;
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;
  virtual ~Driver() = default;

  [[nodiscard]] virtual bool online() const = 0;
  /// True if the mode can translate that subtype.
  [[nodiscard]] virtual bool knows(MessageType type, std::string_view subtype) const = 0;
  /// True if the robot reports when a command of that subtype is over.
  [[nodiscard]] virtual bool tells_end(std::string_view subtype) const = 0;
  [[nodiscard]] virtual const RobotValue* value(std::string_view name) const = 0;
  /// True if what is heard of the robot after a command of that subtype was handed over may have left it before it had
  /// the command: it speaks by itself, and does not show that it has it.
  [[nodiscard]] virtual bool values_lag(std::string_view /*subtype*/) const { return false; }
  /// True if requests are answered from value(), without a request to the robot.
  [[nodiscard]] virtual bool answers_from_values() const { return false; }
  /// For a mode that receives a request's values only after subscribing: from now on value() has them, until unwatch().
  virtual void watch(std::string_view /*subtype*/, const DriverOut&) {}
  virtual void unwatch(std::string_view /*subtype*/, const DriverOut&) {}
  /// Why value() has none, if the robot has reported a reason.
  [[nodiscard]] virtual std::optional<Error> problem(std::string_view) const { return std::nullopt; }

  /// Errors: no_field_channel, robot_offline, queue_full, unknown_subtype, bad_value, not_escapable.
  virtual Result<Progress> hand_over(const Handover& message, Now now, const DriverOut& out) = 0;
  /// True while a command handed over waits or is carried out, as far as the robot reports.
  [[nodiscard]] virtual bool runs(Token) const { return false; }
  /// No service waits for the message any more: it is dropped unless it is on its way already.
  virtual void forget(Token, Now, const DriverOut&) {}
  /// Ends the motion of one command, without a fence; also of one that the mode does not know any more, because an
  /// earlier connection began it. Halted tells that the robot has taken it, if that can be seen; Ended or Refused may
  /// come before it. After LinkDown none of them comes: the halt may be lost.
  virtual void halt(Token token, Now now, const DriverOut& out) = 0;
  /// What was sent this long ago has reached the robot, unless LinkDown came meanwhile.
  [[nodiscard]] virtual Duration silence_bound() const { return kTcpSilence; }

  /// Drops everything that waits and orders the robot to stop. The ticket comes back in Stopped; without a connection
  /// there is none.
  virtual Result<Token> stop(Now now, const DriverOut& out) = 0;
  virtual Result<Token> release(Now now, const DriverOut& out) = 0;
  /// True while the robot may still be in the stop that was ordered.
  [[nodiscard]] virtual bool may_be_stopped() const = 0;

  // Of the connections that the shell holds to the robot.
  virtual void on_up(Channel, Now, const DriverOut&) {}
  virtual void on_down(Channel, const std::string& /*reason*/, Now, const DriverOut&) {}
  virtual void on_bytes(Channel, BytesView, Now, const DriverOut&) {}
  virtual void on_bridge(const BridgeEvent&, Now, const DriverOut&) {}
  virtual void on_bridge(const BridgeState&, Now, const DriverOut&) {}
  /// The process ends: sends the robot its last messages.
  virtual void leave(Now, const DriverOut&) {}
  virtual void tick(Now now, const DriverOut& out) = 0;
  [[nodiscard]] virtual std::optional<MonotonicTime> next_deadline() const = 0;
};

}  // namespace trb::drivers
