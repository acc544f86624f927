// The direct mode over Modbus: a command writes coils and registers, the device's values are polled in rounds. The
// shell makes one call at a time, so that a stop waits for one answer at most.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/drivers/modbus/commands.hpp"
#include "common/drivers/modbus/poll.hpp"
#include "common/drivers/request_queue.hpp"
#include "common/drivers/words_driver.hpp"

namespace trb::drivers {

class ModbusDriver : public WordsDriver<std::vector<ModbusAssignment>> {
 public:
  /// Polls the values that requests and the description's faults, sensors and ends of skills need.
  ModbusDriver(const DriverSettings& settings, ModbusCommands commands);

  /// A connection alone is not enough: a hung device still accepts it.
  [[nodiscard]] bool online() const override { return up_ && heard_; }
  [[nodiscard]] const RobotValue* value(std::string_view name) const override {
    return poll_.value(name_of_value(name));
  }
  [[nodiscard]] bool answers_from_values() const override { return true; }
  [[nodiscard]] std::optional<Error> problem(std::string_view name) const override {
    return poll_.problem(name_of_value(name));
  }

  Result<Progress> hand_over(const Handover& message, Now now, const DriverOut& out) override;
  [[nodiscard]] bool runs(Token token) const override;
  void forget(Token token, Now now, const DriverOut& out) override;
  void halt(Token token, Now now, const DriverOut& out) override;
  Result<Token> stop(Now now, const DriverOut& out) override;
  Result<Token> release(Now now, const DriverOut& out) override;

  void on_up(Channel channel, Now now, const DriverOut& out) override;
  void on_down(Channel channel, const std::string& reason, Now now, const DriverOut& out) override;
  void on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) override;
  void tick(Now now, const DriverOut& out) override { pump(now, out); }
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

 private:
  struct Write {
    std::string meant;  ///< "speed (holding 0)"
    ModbusPlace place;
    std::vector<std::uint16_t> words;
  };
  using Queue = RequestQueue<Write>;
  using Job = Queue::Job;

  Result<std::vector<Write>> fill(std::string_view subtype, BytesView data) const;
  void pump(Now now, const DriverOut& out);
  static ModbusCall call_of(const Job& job);
  void on_poll(const ModbusAnswer& answer, Now now, const DriverOut& out);
  void on_write(const ModbusAnswer& answer, const DriverOut& out);
  void on_done(const Job& job, const DriverOut& out);
  void on_exception(const Job& job, std::uint8_t exception, const DriverOut& out);
  void drop_for_stop(const DriverOut& out);
  [[nodiscard]] static Error lost(const Job& job, bool under_way, const std::string& reason);

  ModbusPoll poll_;

  bool up_ = false;
  bool heard_ = false;  ///< an answer was received on this connection
  Queue queue_;
};

}  // namespace trb::drivers
