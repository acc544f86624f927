// The values that are polled from a Modbus device, and the last result of each.
#pragma once

#include <string>
#include <vector>

#include "common/drivers/modbus/call.hpp"
#include "common/drivers/modbus/syntax.hpp"
#include "common/drivers/polled_values.hpp"

namespace trb::drivers {

class ModbusPoll : public PolledValues {
 public:
  /// `probe` is polled if nothing else is, so that a lost device is noticed; any answer to it is good.
  ModbusPoll(const ModbusPlaces& polled, const ModbusPlace& probe, Duration period);

  /// A new connection: no value is known, all are requested at once, neighbours together.
  void restart(Now now);
  /// When call() is to be made.
  [[nodiscard]] MonotonicTime due() const { return due_; }
  /// The next one of the round.
  [[nodiscard]] ModbusCall call() const;
  /// The answer to call().
  Changes on_answer(const ModbusAnswer& answer, Now now);

 private:
  struct Item {
    std::string name;
    ModbusPlace place;
  };
  /// Adjacent values, read in one call.
  struct Block {
    std::uint16_t count = 0;
    std::vector<Item> items;
  };

  static bool continues(const Block& block, const ModbusPlace& place);
  void split(Block block);
  void take(const Block& block, const ModbusAnswer& answer, Now now, Changes& changes);
  bool is_busy_briefly(Now now);
  void advance(Now now);

  Duration period_;
  std::vector<Block> whole_;   ///< as on a new connection
  std::vector<Block> blocks_;  ///< of these, what a device refuses is read alone
  bool probes_ = false;        ///< the only block is the probe
  std::size_t at_ = 0;
  std::optional<MonotonicTime> busy_since_;
  MonotonicTime due_;  ///< when the current or next round begins
};

}  // namespace trb::drivers
