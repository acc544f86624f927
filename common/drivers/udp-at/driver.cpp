#include "common/drivers/udp-at/driver.hpp"

#include <algorithm>
#include <utility>

#include "common/drivers/udp-at/values.hpp"

namespace trb::drivers {
namespace {

/// The drone needs a command at least every 50 ms.
constexpr Duration kCommandPeriod = std::chrono::milliseconds(30);
constexpr Duration kWakePeriod = std::chrono::seconds(1);
constexpr Duration kDemoPeriod = std::chrono::milliseconds(500);
constexpr Duration kYounger = std::chrono::milliseconds(100);
/// Its watchdog's bit comes with every gap of 50 ms and goes with COMWDG: only one that stays is a fault.
constexpr Duration kWatchdogStays = std::chrono::seconds(1);
constexpr const char* kLink = "link";
constexpr std::size_t kMaxDatagram = 1024;
constexpr BytesView kWakeUp("\1\0\0\0", 4);
constexpr const char* kDemo = R"("general:navdata_demo","TRUE")";
constexpr std::uint32_t kLinkFaults = kArComWatchdog | (1U << 13U);

Error offline() {
  return fail(Errc::robot_offline, "the drone tells nothing: no navdata",
              "look at its power, its network and its address");
}

}  // namespace

AtDriver::AtDriver(const DriverSettings& settings, AtCommands commands)
    : CommandsDriver(settings.id, settings.commands, std::move(commands)),
      names_(settings.commands.values.begin(), settings.commands.values.end()) {
  std::erase_if(commands_, [](const auto& command) { return command.second.empty(); });
  for (const auto& [subtype, lines] : commands_) {
    if (subtype == "stop") stop_lands_ = lines.front().action == AtAction::land;
    if (lines.front().action == AtAction::recover) recover_ = subtype;
  }
}

bool AtDriver::tells_end(std::string_view subtype) const {
  const auto found = commands_.find(subtype);
  return found != commands_.end() && std::ranges::any_of(found->second, at_tells_end);
}

const RobotValue* AtDriver::value(std::string_view name) const {
  const std::string_view asked = name_of_value(name);
  const auto own = names_.find(asked);
  return find_value(values_, own == names_.end() ? asked : own->second);
}

Result<Progress> AtDriver::hand_over(const Handover& message, Now now, const DriverOut& out) {
  const auto lines = commands_.find(message.subtype);
  if (lines == commands_.end()) return fail(Errc::unknown_subtype, "commands.json has no such command");
  if (!online_) return offline();
  const auto orders = fill_at_lines(lines->second, message.data);
  if (!orders) return orders.error();
  if (Status fits = check_state(*orders); !fits) return fits.error();
  const auto waits = begin(message, *orders, now, out);
  if (!waits) return waits.error();
  out.out.count("to_robot." + std::string(message.subtype));
  write(now, out);
  return *waits ? Progress::queued : Progress::handed_over;
}

/// A drone on the ground, or with its motors cut, would silently ignore an order to move.
Status AtDriver::check_state(const std::vector<AtOrder>& orders) const {
  for (const AtOrder& order : orders) {
    const bool flies = order.action == AtAction::hover || order.action == AtAction::move;
    if ((flies || order.action == AtAction::take_off) && drone_.has(kArEmergency)) {
      const std::string problems = ar_problems(drone_.state);
      return fail(
          Errc::robot_error, "the drone's motors are cut" + (problems.empty() ? "" : " (" + problems + ")"),
          "look at the drone, then trb send " + own_id_ + " command " + (recover_.empty() ? "recover" : recover_));
    }
    if (flies && !drone_.airborne()) {
      return fail(Errc::conflict, "the drone is not in the air", "let it take off first");
    }
  }
  return Done{};
}

/// True: the drone will report that it has accepted it.
Result<bool> AtDriver::begin(const Handover& message, const std::vector<AtOrder>& orders, Now now,
                             const DriverOut& out) {
  std::size_t size = 0;
  for (const AtOrder& order : orders) size += order.name.size() + order.arguments.size() + 32;
  if (size > kMaxDatagram - 128)
    return fail(Errc::too_large, "the drone takes 1024 bytes at once", "send less at once");
  // Before any of them takes effect: of what is refused nothing may fly.
  const auto configs = std::ranges::count(orders, "CONFIG", &AtOrder::name);
  if (Status room = configs_.check_room(static_cast<std::size_t>(configs)); !room) return room.error();
  bool waits = false;
  for (const AtOrder& order : orders) {
    if (order.name == "CONFIG") {
      configs_.add(message.token, order.arguments);
      waits = true;
    } else if (order.action == AtAction::send) {
      calls_.push_back({order.name, order.arguments});
    } else {
      // Level ground is where it stands now: the drone needs this before each take-off.
      if (order.action == AtAction::take_off && !drone_.has(kArFlying)) calls_.push_back({"FTRIM", ""});
      flight_.begin(message.token, std::string(message.subtype), order, now, out);
      waits = waits || order.action == AtAction::emergency || order.action == AtAction::recover;
    }
  }
  return waits;
}

void AtDriver::forget(Token token, Now, const DriverOut&) {
  configs_.forget(token);
}

void AtDriver::halt(Token token, Now now, const DriverOut& out) {
  configs_.forget(token);
  if (!online_) return;
  out.out.count("to_robot.stop");
  flight_.stop(drone_, stop_lands_);
  halting_ = token;
  stopped_at_ = now.mono;
  write(now, out);
}

Result<Token> AtDriver::stop(Now now, const DriverOut& out) {
  configs_.drop_all(fail(Errc::fenced, "the drone was stopped before it took this message", "trb release " + own_id_),
                    out);
  if (!online_) return offline();
  if (!commands_.contains("stop")) return fail(Errc::unknown_subtype, "commands.json has no \"stop\" for this robot");
  may_be_stopped_ = true;
  halting_.reset();
  out.out.count("to_robot.stop");
  flight_.stop(drone_, stop_lands_);
  stood_ = at_is_still(drone_) && (!stop_waits_ || stood_);
  stop_waits_ = ++last_ticket_;
  stopped_at_ = now.mono;
  write(now, out);
  return last_ticket_;
}

void AtDriver::confirm_stop(Now now, const DriverOut& out) {
  if (now.mono - stopped_at_ < kYounger || !at_is_still(drone_)) return;
  if (halting_) out.emit(Halted{*std::exchange(halting_, std::nullopt)});
  if (stop_waits_) out.emit(Stopped{*std::exchange(stop_waits_, std::nullopt), true, stood_});
}

Result<Token> AtDriver::release(Now, const DriverOut& out) {
  if (!online_) return offline();
  may_be_stopped_ = false;
  stop_waits_.reset();
  out.emit(Released{++last_ticket_});
  return last_ticket_;
}

void AtDriver::on_up(Channel channel, Now now, const DriverOut&) {
  if (channel == Channel::command) command_up_ = true;
  if (channel != Channel::monitor) return;
  monitor_up_ = true;
  next_wake_ = now.mono;
}

void AtDriver::on_down(Channel channel, const std::string& reason, Now, const DriverOut& out) {
  if (channel == Channel::command) command_up_ = false;
  if (channel == Channel::monitor) monitor_up_ = false;
  if (channel != Channel::field) go_down(reason, out);
}

void AtDriver::on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) {
  if (channel != Channel::monitor || !monitor_up_) return;
  const auto drone = read_ar_navdata(bytes);
  if (!drone) {
    const bool sum = drone.error().code == Errc::bad_signature;
    return out.refuse(sum ? "wrong_checksum" : "bad_navdata", drone.error().what);
  }
  // After a silence it may be another start of the drone, which counts from 1 again.
  const bool anew = now.mono - heard_ >= kLost;
  if (!anew && drone->sequence <= drone_.sequence) {
    return out.refuse("old_navdata",
                      "navdata " + std::to_string(drone->sequence) + " came after " + std::to_string(drone_.sequence));
  }
  heard_ = now.mono;
  on_navdata(*drone, now, out);
}

void AtDriver::on_navdata(const ArNavdata& drone, Now now, const DriverOut& out) {
  watchdog_due_ = watchdog_due_ || drone.has(kArComWatchdog);
  configs_.on_navdata(drone.has(kArCommandHeard), out);
  if (!drone.demo) {
    drone_.sequence = drone.sequence;
    if (configs_.empty() && now.mono >= next_demo_) {
      next_demo_ = now.mono + kDemoPeriod;
      configs_.add(0, kDemo);
    }
    return write(now, out);
  }
  drone_ = drone;
  told_ = now.mono;
  if (!online_ && command_up_) come_up(now, out);
  if (!online_) return;
  remember(drone, now);
  flight_.on_navdata(drone, now, out);
  report_faults(without_passing(drone, now), out);
  confirm_stop(now, out);
  out.emit(ValuesHeard{});
}

void AtDriver::come_up(Now now, const DriverOut& out) {
  online_ = true;
  // After a reconnection every fault is reported again; that its watchdog waited for this node is not its fault.
  known_faults_ = kLinkFaults;
  flight_.follow(drone_);
  next_state_ = now.mono;
  out.emit(LinkUp{});
  out.emit(FaultOver{kLink});
}

void AtDriver::go_down(const std::string& reason, const DriverOut& out) {
  configs_.drop_all(fail(Errc::robot_offline, "the drone's link was lost: " + reason, "look at the drone"), out);
  calls_.clear();
  values_.clear();
  heard_ = {};
  bitten_.reset();
  drone_.sequence = 0;
  if (!std::exchange(online_, false)) return;
  flight_.lose(reason, out);
  stop_waits_.reset();
  halting_.reset();
  // From now on nothing is sent: the drone's own watchdog makes it hover, then land.
  const bool in_air = drone_.has(kArFlying);
  out.emit(FaultSaid{"", in_air ? Severity::critical : Severity::warning,
                     "link lost" + std::string(in_air ? " in the air: the drone hovers, then lands by itself" : "") +
                         " (" + reason + ")",
                     kLink});
  out.emit(LinkDown{reason});
}

/// The drone's state without a watchdog's bit that was only just set.
ArNavdata AtDriver::without_passing(ArNavdata drone, Now now) {
  if (!drone.has(kArComWatchdog)) bitten_.reset();
  if (!bitten_ && drone.has(kArComWatchdog)) bitten_ = now.mono;
  if (bitten_ && now.mono - *bitten_ < kWatchdogStays) drone.state &= ~kArComWatchdog;
  return drone;
}

void AtDriver::report_faults(const ArNavdata& drone, const DriverOut& out) {
  const std::uint32_t risen = drone.state & ~known_faults_;
  known_faults_ = drone.state;
  const bool cut = (risen & kArEmergency) != 0;
  const std::string problems = ar_problems(drone.state);
  for (const ArFault& fault : ar_faults()) {
    if ((drone.state & fault.bit) == 0) out.emit(FaultOver{std::string(fault.name)});
  }
  for (const ArFault& fault : ar_faults()) {
    if ((risen & fault.bit) == 0) continue;
    std::string text(fault.text);
    if (fault.bit == kArEmergency && !problems.empty()) text += " (" + problems + ")";
    if (fault.bit == kArBatteryLow) text += ": " + std::to_string(drone.demo->battery) + " %";
    out.emit(FaultSaid{"", fault.severity, std::move(text), std::string(fault.name)});
    if (cut) return;  // its causes are in its text
  }
}

void AtDriver::remember(const ArNavdata& drone, Now now) {
  for (ArValue& value : ar_values(drone)) {
    values_[std::move(value.name)] = RobotValue{{value.number}, std::move(value.json), now.mono};
  }
}

/// One datagram: commands that are sent once, then the state that is sent repeatedly.
void AtDriver::write(Now now, const DriverOut& out) {
  if (!command_up_) return;
  if (std::exchange(watchdog_due_, false)) calls_.insert(calls_.begin(), AtCall{"COMWDG", ""});
  configs_.run(now, out, calls_);
  if (online_) {
    calls_.push_back({"REF", flight_.reference()});
    calls_.push_back({"PCMD", flight_.motion()});
    next_state_ = std::max(next_state_ + kCommandPeriod, now.mono + kCommandPeriod / 2);
  }
  Bytes datagram;
  for (const AtCall& call : std::exchange(calls_, {})) {
    const std::string line = at_line(call.name, ++sequence_, call.arguments);
    if (datagram.size() + line.size() > kMaxDatagram) out.robot.write(Channel::command, std::exchange(datagram, {}));
    datagram += line;
  }
  if (!datagram.empty()) out.robot.write(Channel::command, std::move(datagram));
}

void AtDriver::tick(Now now, const DriverOut& out) {
  if (online_ && now.mono - told_ >= kLost) go_down("no navdata for 2 s", out);
  if (monitor_up_ && !online_ && now.mono >= next_wake_) {
    next_wake_ = now.mono + kWakePeriod;
    out.robot.write(Channel::monitor, Bytes(kWakeUp));
  }
  flight_.tick(now, out);
  const auto config = configs_.next_deadline();
  if ((online_ && now.mono >= next_state_) || (config && now.mono >= *config)) write(now, out);
}

std::optional<MonotonicTime> AtDriver::next_deadline() const {
  const auto state = online_ ? earlier(next_state_, told_ + kLost) : std::nullopt;
  const auto wake = monitor_up_ && !online_ ? std::optional(next_wake_) : std::nullopt;
  return earlier(earlier(state, wake), configs_.next_deadline());
}

}  // namespace trb::drivers
