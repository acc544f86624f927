#include "common/drivers/arcos/driver.hpp"

#include <cmath>

#include "common/drivers/text/number_text.hpp"

namespace trb::drivers {
namespace {

/// A packet read this long after a command was written is certainly newer than the command.
constexpr Duration kSipPeriod = std::chrono::milliseconds(100);
/// How far from 0 (mm) a robot must have been before its odometry began again, for that to matter.
constexpr double kMoved = 500;
/// How long motors may take to switch on.
constexpr Duration kEnabling = std::chrono::seconds(1);

Error offline() {
  return fail(Errc::robot_offline, "the robot is not connected", "look at its power and network, and at robot.host");
}

}  // namespace

ArcosDriver::ArcosDriver(const DriverSettings& settings, ArcosCommands commands)
    : CommandsDriver(settings.id, settings.commands, std::move(commands.commands)),
      fields_(std::move(commands.values)) {}

bool ArcosDriver::tells_end(std::string_view subtype) const {
  const auto found = commands_.find(subtype);
  return found != commands_.end() && !found->second.empty() && found->second.back().travel;
}

Result<Progress> ArcosDriver::hand_over(const Handover& message, Now now, const DriverOut& out) {
  const auto found = commands_.find(message.subtype);
  if (found == commands_.end()) return fail(Errc::unknown_subtype, "commands.json has no such command");
  if (!online()) return offline();
  const auto order = fill_arcos(found->second, message.data);
  if (!order) return order.error();
  if (Status may = may_go(message, *order); !may) return may.error();
  if (order->moves || order->stops) {
    end_journey("the robot was given '" + std::string(message.subtype) + "' meanwhile", out);
  }
  out.out.count("to_robot." + std::string(message.subtype));
  send(*order, now, out);
  if (!order->goal) return Progress::handed_over;
  // An earlier command would continue during the turn.
  link_.send(arcos_command(kArcosStop), now, out);
  journey_.emplace(Journey{message.token, !message.skill.empty(), ArcosJourney(*order->goal)});
  out.emit(Started{message.token});
  return Progress::queued;
}

Status ArcosDriver::may_go(const Handover& message, const ArcosOrder& order) const {
  if (!order.moves) return Done{};
  if (journey_ && journey_->is_skill) {
    return fail(Errc::busy, "the robot is on its way for a skill", "wait for its end, or stop the robot");
  }
  if (!order.enables.value_or(false) && !sip_->motors()) {
    return fail(Errc::robot_error, "'" + std::string(message.subtype) + "' would do nothing: " + arcos_hindrance(*sip_),
                "look at the robot, then trb release " + own_id_ + " switches its motors on");
  }
  return Done{};
}

void ArcosDriver::send(const ArcosOrder& order, Now now, const DriverOut& out) {
  if (order.resets_origin) odometry_.expect_origin();
  if (order.enables) {
    motors_wanted_ = *order.enables;
    enabled_at_ = now.mono;
  }
  if (!order.packets.empty()) link_.send(order.packets, now, out);
}

void ArcosDriver::end_journey(const std::string& failure, const DriverOut& out) {
  if (!journey_) return;
  const Journey ended = *std::exchange(journey_, std::nullopt);
  // A sender other than the scheduler was answered at its begin, so only the log shows the end.
  if (ended.is_skill) return out.emit(Ended{ended.token, failure.empty(), failure});
  if (!failure.empty()) out.refuse("not_arrived", failure);
}

Result<ArcosOrder> ArcosDriver::own_words(const std::string& subtype) const {
  const auto found = commands_.find(subtype);
  if (found == commands_.end()) {
    return fail(Errc::unknown_subtype, "commands.json has no \"" + subtype + "\" for this robot");
  }
  return fill_arcos(found->second, {});
}

void ArcosDriver::halt(Token token, Now now, const DriverOut& out) {
  if (runs(token)) journey_.reset();
  if (!online()) return;
  const auto words = own_words("stop");
  if (!words) return refuse_halt(token, out);
  out.out.count("to_robot.stop");
  send(*words, now, out);
  halting_ = token;
  told_at_ = now.mono;
}

Result<Token> ArcosDriver::stop(Now now, const DriverOut& out) {
  const bool was_still = sip_ && sip_->is_still() && !journey_;
  end_journey("the robot was stopped", out);
  halting_.reset();
  if (!online()) return offline();
  const auto words = own_words("stop");
  if (!words) return words.error();
  may_be_stopped_ = true;
  release_waits_.reset();
  told_at_ = now.mono;
  out.out.count("to_robot.stop");
  send(*words, now, out);
  stood_ = was_still && (!stop_waits_ || stood_);
  stop_waits_ = ++last_ticket_;
  return last_ticket_;
}

Result<Token> ArcosDriver::release(Now now, const DriverOut& out) {
  if (!online()) return offline();
  may_be_stopped_ = false;
  stop_waits_.reset();
  told_at_ = now.mono;
  const auto words = own_words("release");
  if (words) {
    out.out.count("to_robot.release");
    send(*words, now, out);
  }
  release_waits_ = ++last_ticket_;
  if (!words || !words->enables.value_or(false)) {
    out.emit(Released{*std::exchange(release_waits_, std::nullopt)});
  }
  return last_ticket_;
}

void ArcosDriver::on_up(Channel channel, Now now, const DriverOut& out) {
  if (channel != Channel::command) return;
  odometry_.begin_again();
  link_.begin(now, out);
}

void ArcosDriver::on_down(Channel channel, const std::string& reason, Now, const DriverOut& out) {
  if (channel != Channel::command) return;
  link_.end();
  const bool was_online = online();
  sip_.reset();
  stop_waits_.reset();
  release_waits_.reset();
  halting_.reset();
  if (!was_online) return;
  // The mode-adapter's skill desk reports a skill's end: it is unknown whether the robot arrives.
  journey_.reset();
  out.emit(LinkDown{reason});
}

void ArcosDriver::on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) {
  if (channel != Channel::command || link_.stage() == ArcosLink::Stage::down) return;
  for (const ArcosPacket& packet : link_.receive(bytes, now, out)) {
    if (const auto sip = read_arcos_sip(packet)) {
      on_sip(*sip, now, out);
    } else if (packet.type == kArcosStopped || packet.type == kArcosMoving) {
      out.refuse("bad_packet", "a packet of the robot's ends before its sonar readings do");
    }
  }
}

void ArcosDriver::on_sip(const ArcosSip& sip, Now now, const DriverOut& out) {
  const bool first = !sip_;
  sip_ = sip;
  odometry_.update(sip);
  for (const auto& [name, fields] : fields_) values_[name] = arcos_value(fields, sip, odometry_, now);
  if (first) on_first_sip(now, out);
  if (sip.motors() && !sip.emergency_stop()) out.emit(FaultOver{kArcosHalted});
  const bool by_now = motors_wanted_ && now.mono - enabled_at_ >= kEnabling;
  if (auto fault = faults_.update(sip, by_now)) out.emit(std::move(*fault));
  go_on(now, out);
  confirm(now, out);
  out.emit(ValuesHeard{});
}

void ArcosDriver::on_first_sip(Now now, const DriverOut& out) {
  motors_wanted_ = true;
  enabled_at_ = now.mono;
  faults_.begin_again();
  out.emit(LinkUp{});
  if (odometry_.jump() <= kMoved) return;
  out.emit(FaultSaid{"", Severity::warning,
                     "its odometry begins again at 0, " + number_text(std::round(odometry_.jump())) +
                         " mm from where the robot was: it was switched on again, and would drive to wrong places "
                         "until it is put to its origin"});
}

void ArcosDriver::go_on(Now now, const DriverOut& out) {
  if (!journey_) return;
  std::string failure = arcos_hindrance(*sip_);
  if (failure.empty()) {
    auto next = journey_->way.on_pose({odometry_.x(), odometry_.y(), sip_->heading}, sip_->is_still(), now.mono);
    if (!next.packet.empty()) link_.send(std::move(next.packet), now, out);
    if (!next.over) return;
    failure = std::move(next.failure);
  }
  if (!failure.empty()) link_.send(arcos_command(kArcosStop), now, out);
  end_journey(failure, out);
}

void ArcosDriver::confirm(Now now, const DriverOut& out) {
  if (now.mono - told_at_ < kSipPeriod) return;
  if (halting_ && sip_->is_still()) out.emit(Halted{*std::exchange(halting_, std::nullopt)});
  if (stop_waits_ && sip_->is_still()) out.emit(Stopped{*std::exchange(stop_waits_, std::nullopt), true, stood_});
  if (release_waits_ && sip_->motors()) out.emit(Released{*std::exchange(release_waits_, std::nullopt)});
}

void ArcosDriver::leave(Now now, const DriverOut& out) {
  if (link_.stage() == ArcosLink::Stage::open)
    link_.send(arcos_command(kArcosStop) + arcos_command(kArcosClose), now, out);
}

void ArcosDriver::tick(Now now, const DriverOut& out) {
  const auto reason = link_.tick(now, out);
  if (reason) give_up(*reason, now, out);
}

void ArcosDriver::give_up(const std::string& reason, Now now, const DriverOut& out) {
  out.refuse("robot_silent", reason);
  out.robot.close(Channel::command, reason);
  const bool was_online = online();
  on_down(Channel::command, reason, now, out);
  // A robot that never answered is reported, too.
  if (!was_online) out.emit(LinkDown{reason});
}

}  // namespace trb::drivers
