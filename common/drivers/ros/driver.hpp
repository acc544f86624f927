// The ros mode: commands.json names a topic for each subtype; trb-ros-bridge, another service of the node, publishes
// and subscribes. No ROS library is linked here.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/drivers/commands_driver.hpp"
#include "common/drivers/ros/commands.hpp"
#include "common/drivers/text/vendor_template.hpp"
#include "proto/bodies/bridge.hpp"

namespace trb::drivers {

/// What a command publishes.
struct RosMessage {
  std::string topic;
  std::string type;
  VendorTemplate data;
};

class RosDriver : public CommandsDriver<std::vector<RosMessage>> {
 public:
  /// Watches the requests that ends of skills, faults and sensors need.
  RosDriver(const DriverSettings& settings, const RosCommands& commands);

  [[nodiscard]] bool online() const override { return up_; }
  [[nodiscard]] bool tells_end(std::string_view) const override { return false; }
  [[nodiscard]] const RobotValue* value(std::string_view name) const override { return find_value(values_, name); }
  [[nodiscard]] bool values_lag(std::string_view) const override { return true; }

  Result<Progress> hand_over(const Handover& message, Now now, const DriverOut& out) override;
  void watch(std::string_view subtype, const DriverOut& out) override;
  void unwatch(std::string_view subtype, const DriverOut& out) override;
  void forget(Token token, Now now, const DriverOut& out) override;
  void halt(Token token, Now now, const DriverOut& out) override;
  /// Within it trb-ros-bridge gives up a master that does not answer.
  [[nodiscard]] Duration silence_bound() const override { return std::chrono::seconds(7); }
  Result<Token> stop(Now now, const DriverOut& out) override;
  Result<Token> release(Now now, const DriverOut& out) override;

  void on_bridge(const BridgeEvent& event, Now now, const DriverOut& out) override;
  void on_bridge(const BridgeState& state, Now now, const DriverOut& out) override;
  void tick(Now now, const DriverOut& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

 private:
  struct Question {
    RosQuestion words;
    bool always = false;                   ///< watched as long as ROS is available
    std::uint64_t watch = 0;               ///< the bridge's token; 0: it is not watched
    std::optional<MonotonicTime> again{};  ///< the watch has failed: when it is ordered again
    Duration pause{};                      ///< between the last failure and that
    MonotonicTime quiet_until{};           ///< that the value is unknown is not logged before
  };
  enum class Purpose : std::uint8_t { command, request, halt, stop, release, watch };
  struct Pending {
    Purpose purpose{};
    Token token = 0;       ///< the message's, also of the one that is halted, or the ticket
    std::string subtype;   ///< of a request or a watch
    std::string source;    ///< the requester
    std::size_t left = 0;  ///< publications that are not done yet
    bool refused = false;  ///< one of a stop's or a halt's was; the others may still arrive
  };

  Result<std::vector<BridgeCommand>> fill(std::string_view subtype, BytesView data) const;
  std::uint64_t send(std::vector<BridgeCommand> commands, Pending pending, const DriverOut& out);
  std::uint64_t ask(const Question& question, BridgeAction action, Pending pending, const DriverOut& out);
  void drop_at_bridge(std::uint64_t key, const DriverOut& out) const;
  void drop_all(Purpose purpose, const DriverOut& out);
  void on_value(const Pending& pending, const BridgeEvent& event, Now now, const DriverOut& out);
  void on_done(std::uint64_t key, Pending& pending, Now now, const DriverOut& out);
  void on_failed(std::uint64_t key, Pending& pending, const BridgeEvent& event, Now now, const DriverOut& out);
  void keep_value(const std::string& subtype, const std::string& data, Now now);
  void lose_value(const std::string& subtype, const BridgeEvent& event, Now now, const DriverOut& out);
  void watch_all(const DriverOut& out);
  void watch_again(Now now, const DriverOut& out);
  void go_down(const std::string& reason, const DriverOut& out);

  std::uint64_t instance_;
  std::map<std::string, Question, std::less<>> questions_;  ///< by the request's subtype

  bool up_ = false;
  std::uint64_t connection_ = 0;
  MonotonicTime heard_;  ///< when the bridge's last state was received
  struct Halting {
    Token token = 0;
    MonotonicTime at;  ///< when it was published
  };
  std::optional<Halting> halting_;
  std::uint64_t last_key_ = 0;
  std::map<std::uint64_t, Pending> pending_;  ///< by the bridge's token
  std::vector<std::uint64_t> late_stops_;     ///< left at a bridge that went silent: its tokens
  RobotValues values_;
};

}  // namespace trb::drivers
