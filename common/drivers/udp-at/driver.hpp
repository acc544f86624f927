// The direct mode over udp-at: an AR.Drone 2 receives AT commands (UDP 5556) and sends navdata (UDP 5554).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/drivers/commands_driver.hpp"
#include "common/drivers/udp-at/commands.hpp"
#include "common/drivers/udp-at/configs.hpp"
#include "common/drivers/udp-at/flight.hpp"

namespace trb::drivers {

class AtDriver : public CommandsDriver<std::vector<AtLine>> {
 public:
  AtDriver(const DriverSettings& settings, AtCommands commands);

  [[nodiscard]] bool online() const override { return online_; }
  [[nodiscard]] bool tells_end(std::string_view subtype) const override;
  [[nodiscard]] const RobotValue* value(std::string_view name) const override;
  [[nodiscard]] bool answers_from_values() const override { return true; }

  Result<Progress> hand_over(const Handover& message, Now now, const DriverOut& out) override;
  [[nodiscard]] bool runs(Token token) const override { return flight_.runs(token); }
  void forget(Token token, Now now, const DriverOut& out) override;
  void halt(Token token, Now now, const DriverOut& out) override;
  [[nodiscard]] Duration silence_bound() const override { return kLost; }
  Result<Token> stop(Now now, const DriverOut& out) override;
  Result<Token> release(Now now, const DriverOut& out) override;

  void on_up(Channel channel, Now now, const DriverOut& out) override;
  void on_down(Channel channel, const std::string& reason, Now now, const DriverOut& out) override;
  void on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) override;
  void tick(Now now, const DriverOut& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

 private:
  /// After this long without a command the drone considers its link lost; after this long without navdata the node
  /// does.
  static constexpr Duration kLost = std::chrono::seconds(2);

  [[nodiscard]] Status check_state(const std::vector<AtOrder>& orders) const;
  Result<bool> begin(const Handover& message, const std::vector<AtOrder>& orders, Now now, const DriverOut& out);
  void on_navdata(const ArNavdata& drone, Now now, const DriverOut& out);
  void come_up(Now now, const DriverOut& out);
  void go_down(const std::string& reason, const DriverOut& out);
  ArNavdata without_passing(ArNavdata drone, Now now);
  void report_faults(const ArNavdata& drone, const DriverOut& out);
  void remember(const ArNavdata& drone, Now now);
  void confirm_stop(Now now, const DriverOut& out);
  void write(Now now, const DriverOut& out);

  std::map<std::string, std::string, std::less<>> names_;  ///< of requests and values -> navdata's
  bool stop_lands_ = false;
  std::string recover_;  ///< the subtype that does it

  bool command_up_ = false;
  bool monitor_up_ = false;
  bool online_ = false;
  std::uint32_t sequence_ = 0;  ///< of the last AT command
  ArNavdata drone_;             ///< as last received
  std::uint32_t known_faults_ = 0;
  MonotonicTime heard_;  ///< when the last good navdata was received
  MonotonicTime told_;   ///< when a position was last reported
  MonotonicTime next_wake_;
  MonotonicTime next_demo_;
  MonotonicTime next_state_;
  bool watchdog_due_ = false;
  std::optional<MonotonicTime> bitten_;  ///< since when its watchdog's bit is set
  std::optional<Token> stop_waits_;
  bool stood_ = false;            ///< when that stop was given
  std::optional<Token> halting_;  ///< the command that is to end
  MonotonicTime stopped_at_;      ///< when one of them was sent
  std::vector<AtCall> calls_;     ///< for the next datagram
  AtFlight flight_;
  AtConfigs configs_;
  RobotValues values_;
};

}  // namespace trb::drivers
