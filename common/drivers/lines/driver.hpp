// The interpreter mode: the robot dials in and receives messages field by field (section 3.2.4,
// proto/FIELD_CHANNEL.md).
#pragma once

#include "common/drivers/driver.hpp"
#include "common/drivers/lines/frame.hpp"
#include "common/drivers/lines/receiver.hpp"
#include "common/drivers/lines/sender.hpp"

namespace trb::drivers {

class LinesDriver : public Driver {
 public:
  LinesDriver(const FieldChannel& settings, std::string own_id);

  [[nodiscard]] bool online() const override { return up_; }
  [[nodiscard]] bool knows(MessageType, std::string_view) const override { return true; }
  [[nodiscard]] bool tells_end(std::string_view) const override { return true; }
  [[nodiscard]] const RobotValue* value(std::string_view) const override { return nullptr; }
  [[nodiscard]] bool values_lag(std::string_view) const override { return !acknowledges(); }

  Result<Progress> hand_over(const Handover& message, Now now, const DriverOut& out) override;
  void forget(Token token, Now now, const DriverOut& out) override;
  void halt(Token token, Now now, const DriverOut& out) override;
  [[nodiscard]] Duration silence_bound() const override;
  Result<Token> stop(Now now, const DriverOut& out) override;
  Result<Token> release(Now now, const DriverOut& out) override;
  [[nodiscard]] bool may_be_stopped() const override { return may_be_stopped_; }

  void on_up(Channel channel, Now now, const DriverOut& out) override;
  void on_down(Channel channel, const std::string& reason, Now now, const DriverOut& out) override;
  void on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) override;
  void tick(Now now, const DriverOut& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

 private:
  /// The command whose `done` or `failed` is awaited; the robot refers to it by its subtype.
  struct Tracked {
    Token token = 0;
    std::string subtype;
    std::string skill;
  };
  struct Halting {  ///< a command that is to end, until the robot confirms the stop with that ticket
    Token token = 0;
    Token ticket = 0;
  };

  [[nodiscard]] bool acknowledges() const { return settings_.acknowledge && settings_.framing != Framing::delay; }
  void on_halted(Token token, const DriverOut& out);
  void read_fields(Now now, const DriverOut& out);
  void take_field(std::string_view field, Now now, const DriverOut& out);
  void take_confirmation(Urgent urgent, Now now, const DriverOut& out);
  void take_message(FieldMessage message, const DriverOut& out);
  void take_report(const FieldMessage& message, const DriverOut& out);
  void take_fault(const FieldMessage& message, const DriverOut& out);
  void drop_connection(const std::string& reason, Now now, const DriverOut& out);

  FieldChannel settings_;
  std::string own_id_;
  FieldText words_;
  FieldReader reader_;
  FieldReceiver receiver_;
  FieldSender sender_;
  bool up_ = false;
  bool may_be_stopped_ = false;
  Token last_ticket_ = 0;
  std::optional<Tracked> tracked_;
  std::optional<Halting> halting_;
};

}  // namespace trb::drivers
