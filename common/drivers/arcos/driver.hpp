// The direct mode over arcos: the node dials a MobileRobots Pioneer and sends it the commands that commands.json
// names; the robot's packets report its position and state. "goto" is driven by this class, step by step.
#pragma once

#include <map>

#include "common/drivers/arcos/commands.hpp"
#include "common/drivers/arcos/journey.hpp"
#include "common/drivers/arcos/link.hpp"
#include "common/drivers/arcos/order.hpp"
#include "common/drivers/arcos/report.hpp"
#include "common/drivers/arcos/state.hpp"
#include "common/drivers/commands_driver.hpp"

namespace trb::drivers {

class ArcosDriver : public CommandsDriver<std::vector<ArcosStep>> {
 public:
  ArcosDriver(const DriverSettings& settings, ArcosCommands commands);

  [[nodiscard]] bool online() const override { return sip_.has_value(); }
  [[nodiscard]] bool tells_end(std::string_view subtype) const override;
  [[nodiscard]] const RobotValue* value(std::string_view name) const override {
    return find_value(values_, name_of_value(name));
  }
  [[nodiscard]] bool answers_from_values() const override { return true; }

  Result<Progress> hand_over(const Handover& message, Now now, const DriverOut& out) override;
  [[nodiscard]] bool runs(Token token) const override { return journey_ && journey_->token == token; }
  void halt(Token token, Now now, const DriverOut& out) override;
  [[nodiscard]] Duration silence_bound() const override { return kArcosSilence; }
  Result<Token> stop(Now now, const DriverOut& out) override;
  Result<Token> release(Now now, const DriverOut& out) override;

  void on_up(Channel channel, Now now, const DriverOut& out) override;
  void on_down(Channel channel, const std::string& reason, Now now, const DriverOut& out) override;
  void on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) override;
  void leave(Now now, const DriverOut& out) override;
  void tick(Now now, const DriverOut& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override { return link_.next_deadline(); }

 private:
  struct Journey {
    Token token = 0;
    bool is_skill = false;
    ArcosJourney way;
  };

  [[nodiscard]] Status may_go(const Handover& message, const ArcosOrder& order) const;
  Result<ArcosOrder> own_words(const std::string& subtype) const;
  void send(const ArcosOrder& order, Now now, const DriverOut& out);
  void end_journey(const std::string& failure, const DriverOut& out);
  void on_sip(const ArcosSip& sip, Now now, const DriverOut& out);
  void on_first_sip(Now now, const DriverOut& out);
  void go_on(Now now, const DriverOut& out);
  void confirm(Now now, const DriverOut& out);
  void give_up(const std::string& reason, Now now, const DriverOut& out);

  std::map<std::string, std::vector<ArcosField>, std::less<>> fields_;  ///< by value

  ArcosLink link_;
  std::optional<ArcosSip> sip_;  ///< the latest one of this connection
  ArcosOdometry odometry_;
  ArcosFaults faults_;
  RobotValues values_;
  std::optional<Journey> journey_;

  bool motors_wanted_ = true;
  MonotonicTime enabled_at_;  ///< when ENABLE was sent
  MonotonicTime told_at_;     ///< when stop, release or a halt was sent
  std::optional<Token> stop_waits_;
  bool stood_ = false;  ///< when that stop was given
  std::optional<Token> release_waits_;
  std::optional<Token> halting_;  ///< the command that is to end
};

}  // namespace trb::drivers
