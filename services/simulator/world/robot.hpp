// A robot that is told field by field (proto/FIELD_CHANNEL.md): its skills take their time, it has no values, and it
// may break.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/simulator/world/dice.hpp"
#include "services/simulator/world/events.hpp"
#include "services/simulator/world/faults.hpp"
#include "services/simulator/world/fleet_plan.hpp"

namespace trb::world {

/// The value by which a robot tells its charge, in percent.
constexpr std::string_view kBattery = "battery";

struct RobotPlan {
  SkillTime usual;                         ///< of skills without a time of their own
  std::map<std::string, SkillTime> times;  ///< by skill, or of one task: "task:ID"
  std::vector<std::string> capabilities;   ///< all are lost if it breaks
};

class Robot {
 public:
  Robot(RobotPlan plan, Events& events, Dice& dice) : plan_(std::move(plan)), events_(events), dice_(dice) {}
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

  /// Bytes of its node.
  void receive(std::string_view bytes);
  /// Its node's connection: where its own bytes go; empty: there is none.
  void connect(std::function<void(std::string bytes)> tell);
  /// From now on it does nothing any more, and says so.
  void fail();
  /// It can do all again, and says so: without a connection once there is one.
  void repair();
  /// From now on it has this charge and tells it; if that is used up, it breaks.
  void set_battery(const Battery& battery);

  [[nodiscard]] bool works() const { return work_ != nullptr; }
  [[nodiscard]] bool is_broken() const { return broken_; }
  [[nodiscard]] const std::optional<Battery>& battery() const { return battery_; }

  std::function<void()> on_begin, on_end;    ///< for whoever watches
  std::function<void()> on_give_up;          ///< the same: it breaks at its work, or is halted
  std::function<void()> on_fail, on_repair;  ///< the same: it breaks, it can do all again
  std::function<std::string()> task;         ///< the one that it is told now
  std::uint64_t overlaps = 0;                ///< commands that came while it was working

 private:
  void take_field(const std::string& field);
  void begin();
  [[nodiscard]] const SkillTime& time_of_work() const;
  void end(bool well);
  void give_up();
  void inform_of_fault();
  void inform_of_repair();
  void inform_of_charge();
  [[nodiscard]] std::string charge_text() const;
  void drain();
  /// `target`: a node; empty: its own.
  void inform(const std::string& subtype, const std::string& data, const std::string& target = {});

  RobotPlan plan_;
  Events& events_;
  Dice& dice_;
  std::shared_ptr<char> life_ = std::make_shared<char>();
  std::shared_ptr<char> work_;  ///< while it works
  std::function<void(std::string)> tell_;
  std::string line_;
  std::string type_, subtype_, source_;
  std::size_t field_ = 0;
  std::string skill_;
  bool broken_ = false;
  bool owes_end_of_fault_ = false;  ///< nobody could be told of the repair
  std::optional<Battery> battery_;
};

}  // namespace trb::world
