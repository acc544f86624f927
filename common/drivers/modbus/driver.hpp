// The direct mode over Modbus: a command writes coils and registers, the device's values are polled in rounds. The
// shell makes one call at a time, so that a stop waits for one answer at most.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/drivers/modbus/commands.hpp"
#include "common/drivers/modbus/poll.hpp"
#include "common/drivers/polled_driver.hpp"

namespace trb::drivers {

struct ModbusWrite {
  std::string meant;  ///< "speed (holding 0)"
  ModbusPlace place;
  std::vector<std::uint16_t> words;
};

class ModbusDriver : public PolledDriver<std::vector<ModbusAssignment>, ModbusWrite, ModbusPoll> {
 public:
  /// Polls the values that requests and the description's faults, sensors and ends of skills need.
  ModbusDriver(const DriverSettings& settings, ModbusCommands commands);

  /// A connection alone is not enough: a hung device still accepts it.
  [[nodiscard]] bool online() const override { return up_ && heard_; }

  /// An answer to each write of a halt, and to the call that is under way, or the connection is closed; then the halt
  /// is held.
  [[nodiscard]] Duration silence_bound() const override { return kMostCalls * timeout_ + halt_time(); }

  void on_up(Channel channel, Now now, const DriverOut& out) override;
  void on_down(Channel channel, const std::string& reason, Now now, const DriverOut& out) override;
  void on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) override;
  void tick(Now now, const DriverOut& out) override { pump(now, out); }
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

 private:
  static constexpr int kMostCalls = 10;

  Result<std::vector<ModbusWrite>> fill(std::string_view subtype, BytesView data) const override;
  void pump(Now now, const DriverOut& out) override;
  [[nodiscard]] bool takes_orders() const override { return up_; }
  static ModbusCall call_of(const Job& job);
  void on_poll(const ModbusAnswer& answer, Now now, const DriverOut& out);
  void on_write(const ModbusAnswer& answer, Now now, const DriverOut& out);
  void on_done(const Job& job, Now now, const DriverOut& out) override;
  [[nodiscard]] static Error lost(const Job& job, bool under_way, const std::string& reason);

  Duration timeout_;
};

}  // namespace trb::drivers
