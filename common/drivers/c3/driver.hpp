// The direct mode over C3: a message is written into a KUKA's variables, field by field or by the assignments of
// commands.json; flags show when the robot's program has taken it and when it is over.
#pragma once

#include <set>

#include "common/drivers/c3/commands.hpp"
#include "common/drivers/c3/faults.hpp"
#include "common/drivers/c3/jobs.hpp"
#include "common/drivers/c3/messages.hpp"
#include "common/drivers/c3/values.hpp"

namespace trb::drivers {

/// Reads the flags in turn, and passes each answer to the part that asked.
class C3Driver : public Driver {
 public:
  C3Driver(const DriverSettings& settings, C3Commands commands);

  [[nodiscard]] bool online() const override { return up_ && heard_; }
  [[nodiscard]] bool knows(MessageType type, std::string_view subtype) const override;
  [[nodiscard]] bool tells_end(std::string_view) const override { return !names_.done.empty(); }
  [[nodiscard]] const RobotValue* value(std::string_view name) const override { return values_.find(name); }

  Result<Progress> hand_over(const Handover& message, Now now, const DriverOut& out) override;
  [[nodiscard]] bool runs(Token token) const override { return jobs_.runs(token); }
  void forget(Token token, Now now, const DriverOut& out) override;
  void halt(Token token, Now now, const DriverOut& out) override;
  [[nodiscard]] Duration silence_bound() const override { return C3Link::kAnswerTime; }
  Result<Token> stop(Now now, const DriverOut& out) override;
  Result<Token> release(Now now, const DriverOut& out) override;
  [[nodiscard]] bool may_be_stopped() const override { return turns_.may_be_stopped() || turns_.may_stand(); }

  void on_up(Channel channel, Now now, const DriverOut& out) override;
  void on_down(Channel channel, const std::string& reason, Now now, const DriverOut& out) override;
  void on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) override;
  void tick(Now now, const DriverOut& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

 private:
  enum class Probe : std::uint64_t { chunk, command, done, out, stopped, stop_message, error, error_of_stop };

  void end_motion(Token token, Now now, const DriverOut& out);
  void go_on(bool free, Now now, const DriverOut& out);
  void poll(Now now, const DriverOut& out);
  void probe(Probe what, const std::string& variable, Now now, const DriverOut& out);
  void drop_connection(const std::string& counted, const std::string& reason, Now now, const DriverOut& out);

  void on_answer(const C3Link::Answer& answer, Now now, const DriverOut& out);
  void on_turn(const C3Link::Answer& answer, Now now, const DriverOut& out);
  void on_probe(Probe what, const C3Reply& reply, Now now, const DriverOut& out);
  void on_stop_message(bool raised, Now now, const DriverOut& out);
  void on_program_stopped(Now now, const DriverOut& out);
  void warn_unknown(const C3Link::Answer& answer, const DriverOut& out);

  std::string own_id_;
  bool fields_;  ///< the robot's program accepts messages field by field
  C3Names names_;

  C3Reader reader_;
  C3Link link_;
  C3PollTimes polls_;
  C3Turns turns_;
  C3Jobs jobs_;
  C3Messages messages_;
  C3Faults faults_;
  C3Values values_;
  bool up_ = false;
  bool heard_ = false;
  std::set<std::string, std::less<>> unknown_;  ///< variables that the robot has refused since it was connected
};

}  // namespace trb::drivers
