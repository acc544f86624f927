// What the node and the fleet receive about the robot: at the welcome and at each change.
#pragma once

#include "common/actor/outbox.hpp"
#include "services/mode-adapter/core/settings.hpp"

namespace trb::adapter {

/// The parts of the robot's state that do not come from its connection.
struct Condition {
  bool fenced = false;
  bool busy = false;
  std::string control;   ///< Holder::text(); empty: nobody
  bool for_runs = true;  ///< false: its holder keeps the scheduler's runs out
  std::vector<OutOfUse> out_of_use{};
  bool operator==(const Condition&) const = default;
};

class RobotStatus {
 public:
  explicit RobotStatus(const Settings& settings);

  void on_up();
  /// Also of a robot that is down already, and for another reason now.
  void on_down(const std::string& reason);
  /// Why the first connection fails.
  void on_no_contact(const std::string& reason);

  [[nodiscard]] AdapterState state(const Condition& condition) const;
  /// Sends everything, as at the first start.
  void welcome(const Condition& condition, Outbox& out);
  /// Sends what has changed since the last call.
  void publish(const Condition& condition, Outbox& out);
  /// Tells the own scheduler once more, which has taken the robot for free by an outcome.
  void repeat(const Condition& condition, Outbox& out) const;

 private:
  enum class Connection : std::uint8_t { offline, online, broken };
  struct Told {
    Connection connection = Connection::offline;
    Condition condition;
    bool operator==(const Told&) const = default;
  };

  void send_profile(const Condition& condition, Outbox& out);
  [[nodiscard]] std::string connection_name() const;

  const Settings& settings_;
  NodeProfile profile_;           ///< the constant part
  std::vector<SkillUse> skills_;  ///< constant, too
  Connection connection_ = Connection::offline;
  std::string detail_ = "no contact yet";
  bool detail_changed_ = false;
  bool had_contact_ = false;
  bool welcomed_ = false;
  Told told_;
};

}  // namespace trb::adapter
