#include "common/drivers/tcp-text/driver.hpp"

#include <array>
#include <cstdio>

#include "common/drivers/tcp-text/reach.hpp"
#include "common/drivers/tcp-text/urscript.hpp"

namespace trb::drivers {
namespace {

constexpr Duration kHung = std::chrono::seconds(3);
/// A state read this long after a command was written is certainly newer than the command.
constexpr Duration kStatePeriod = std::chrono::milliseconds(100);
/// A state read this long after a halt was written comes after the last words of the program that it has ended.
constexpr Duration kHaltShown = std::chrono::milliseconds(300);
/// An error this shortly before a stop counts as its cause.
constexpr Duration kSameCause = std::chrono::seconds(2);
/// The same warning is sent to the fleet once in this time, and different ones with this pause between them.
constexpr Duration kQuiet = std::chrono::seconds(10);
constexpr Duration kWarningPause = std::chrono::seconds(1);
constexpr const char* kSafety = "safety";
constexpr std::int32_t kWorthALine = 2;  ///< reports of this level or higher are logged: warning

std::string number_json(double number) {
  std::array<char, 40> text{};  // the monitor accepts nothing beyond 1000 rad or m
  std::snprintf(text.data(), text.size(), "%.4f", number);
  return text.data();
}

std::string joints_json(const std::array<double, 6>& joints) {
  std::string out = "[";
  for (const double joint : joints) out += (out.size() > 1 ? "," : "") + number_json(joint);
  return out + "]";
}

double rtde_rate(const VendorCommands& words) {
  const auto found = words.numbers.find(std::string(kRtdeRate));
  return found == words.numbers.end() ? kUsualRtde : found->second;
}

/// What the controller still reports of an earlier process's program must not be taken for one of this process.
std::string first_name(std::uint64_t instance) {
  return "trb_" + std::to_string(instance % 1'000'000) + "_";
}

std::string text_or_empty(const std::map<std::string, std::string>& words, const std::string& key) {
  const auto found = words.find(key);
  return found == words.end() ? std::string() : found->second;
}

}  // namespace

TcpTextDriver::TcpTextDriver(const VendorCommands& words, std::string own_id, std::uint64_t instance)
    : CommandsDriver(std::move(own_id), words),
      stop_text_(text_or_empty(words.commands, "stop")),
      release_text_(text_or_empty(words.commands, "release")),
      urscript_(words.language == "urscript"),
      wraps_(words.wrap == "urscript-program"),
      has_monitor_(words.monitor.has_value()),
      name_(first_name(instance)),
      rtde_(rtde_rate(words)) {
  for (const auto& [subtype, text] : words.commands) {
    commands_.emplace(subtype, TcpCommand{VendorTemplate(text), wraps_ && !is_interface_command(text), text});
  }
}

bool TcpTextDriver::tells_end(std::string_view subtype) const {
  const auto found = commands_.find(subtype);
  return found != commands_.end() && found->second.wrapped && has_monitor_;
}

Result<Progress> TcpTextDriver::hand_over(const Handover& message, Now now, const DriverOut& out) {
  const auto command = commands_.find(message.subtype);
  if (command == commands_.end()) return fail(Errc::unknown_subtype, "commands.json has no such command");
  if (!online()) {
    return fail(Errc::robot_offline, "the robot's controller is not connected",
                "look at its power, network and address");
  }
  const VendorTemplate& words = command->second.words;
  auto text = urscript_ ? words.fill(message.data, urscript_literal) : words.fill_line(message.data);
  if (!text) return text.error();
  if (command->second.wrapped && has_monitor_) {
    if (auto why = disabled(now)) return std::move(*why);
    if (auto why = out_of_reach(*text, reach_)) return std::move(*why);
  }
  last_write_ = now.mono;
  out.out.count("to_robot." + std::string(message.subtype));
  if (!command->second.wrapped) {
    *text += '\n';
    out.robot.write(Channel::command, std::move(*text));
    return Progress::handed_over;
  }
  const Status submitted = submit_program(message, *text, out);
  if (!submitted) return submitted.error();
  return has_monitor_ ? Progress::queued : Progress::handed_over;
}

Status TcpTextDriver::submit_program(const Handover& message, std::string_view lines, const DriverOut& out) {
  const std::string name = name_ + std::to_string(++programs_);
  std::string text = urscript_program(name, lines);
  if (!has_monitor_) {
    out.robot.write(Channel::command, std::move(text));
    return Done{};
  }
  return track_.submit({message.token, name, std::move(text), urscript_end_text(name), !message.skill.empty()}, out);
}

void TcpTextDriver::write_line(std::string_view text, Now now, const DriverOut& out) {
  last_write_ = now.mono;
  out.robot.write(Channel::command, std::string(text) + "\n");
}

void TcpTextDriver::forget(Token token, Now, const DriverOut& out) {
  track_.drop(token, out);
}

void TcpTextDriver::halt(Token token, Now now, const DriverOut& out) {
  if (track_.halt(token)) return out.emit(Halted{token});
  if (!command_up_) return;
  if (stop_text_.empty()) return refuse_halt(token, out);
  out.out.count("to_robot.stop");
  write_line(stop_text_, now, out);
  halting_ = Halting{token, now.mono};
}

void TcpTextDriver::look_at_halt(Now now, const DriverOut& out) {
  if (!halting_ || program_running_ || now.mono - halting_->at < kHaltShown) return;
  const Token token = std::exchange(halting_, std::nullopt)->token;
  track_.drop(token, out);
  out.emit(Halted{token});
}

Result<Token> TcpTextDriver::stop(Now now, const DriverOut& out) {
  const bool was_idle = surely_idle() && now.mono - last_state_ < kHung;
  halting_.reset();
  program_ran_ = program_running_ || track_.runs_any();
  program_unanswered_ = track_.has_sent();
  track_.drop_all(fail(Errc::fenced, "the robot was stopped before it took this message", "trb release " + own_id_),
                  out);
  if (!command_up_) return fail(Errc::robot_offline, "the robot's controller is not connected");
  if (stop_text_.empty()) return fail(Errc::unknown_subtype, "commands.json has no \"stop\" for this robot");
  may_be_stopped_ = true;
  out.out.count("to_robot.stop");
  write_line(stop_text_, now, out);
  const bool only_stop = !stop_waits_;
  stop_waits_ = ++last_ticket_;
  if (was_idle || !has_monitor_) confirm_stop(has_monitor_ && only_stop, out);
  return last_ticket_;
}

void TcpTextDriver::confirm_stop(bool stood, const DriverOut& out) {
  if (!stop_waits_) return;
  out.emit(Stopped{*stop_waits_, has_monitor_, stood});
  stop_waits_.reset();
}

/// The controller names no text that it refuses, but answers in the order in which it got them.
bool TcpTextDriver::is_about_stop(std::string_view exception) {
  if (!stop_waits_) return false;
  const bool about_script = exception.starts_with("compile_error") || exception.starts_with("syntax_error");
  if (program_ran_ && !about_script) return false;  // so the program ended that ran
  return !std::exchange(program_unanswered_, false);
}

void TcpTextDriver::on_exception(const UrException& raised, const DriverOut& out) {
  const std::string shown =
      "line " + std::to_string(raised.line) + ", column " + std::to_string(raised.column) + ": " + raised.text;
  if (is_about_stop(raised.text))
    out.emit(NotStopped{*stop_waits_, fail(Errc::robot_error, shown, R"(correct "stop" in commands.json)")});
  track_.on_exception(raised.text, shown, out);
}

Result<Token> TcpTextDriver::release(Now now, const DriverOut& out) {
  if (!command_up_) return fail(Errc::robot_offline, "the robot's controller is not connected");
  may_be_stopped_ = false;
  if (!release_text_.empty()) {
    out.out.count("to_robot.release");
    write_line(release_text_, now, out);
  }
  out.emit(Released{++last_ticket_});
  return last_ticket_;
}

void TcpTextDriver::on_up(Channel channel, Now now, const DriverOut& out) {
  const bool before = online();
  if (channel == Channel::command) command_up_ = true;
  if (channel == Channel::monitor) {
    monitor_up_ = true;
    heard_ = false;
    last_heard_ = now.mono;
    monitor_.clear();
  }
  if (channel == Channel::data) {
    data_up_ = true;
    sampled_at_.reset();
    last_data_ = now.mono;
    out.robot.write(Channel::data, rtde_.begin());
  }
  if (!before && online()) out.emit(LinkUp{});
}

void TcpTextDriver::on_down(Channel channel, const std::string& reason, Now, const DriverOut& out) {
  const bool before = online();
  if (channel == Channel::command) command_up_ = false;
  if (channel == Channel::monitor) monitor_up_ = heard_ = false;
  if (channel == Channel::data) data_up_ = false;
  if (!monitor_up_) safety_ = kUrSafetyNormal;  // after a reconnection every fault is reported again
  if (!before || online()) return;
  halting_.reset();
  track_.drop_all(fail(Errc::robot_offline, "the connection to the robot's controller was lost: " + reason,
                       "look at its power and network"),
                  out);
  out.emit(LinkDown{reason});
}

void TcpTextDriver::on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) {
  if (channel == Channel::data && data_up_) return on_data(bytes, now, out);
  // The command port reports the same state again, in a form that differs between vendors.
  if (channel != Channel::monitor || !monitor_up_) return;
  events_.clear();
  const Status read = monitor_.add(bytes, events_);
  for (const UrEvent& event : events_) on_event(event, now, out);
  if (!read) drop_monitor("bad_packet", "bad packet: " + read.error().what, now, out);
}

void TcpTextDriver::on_event(const UrEvent& event, Now now, const DriverOut& out) {
  std::visit(Overloaded{
                 [&](const UrState& state) { on_state(state, now, out); },
                 [&](const UrProgramStarted& started) {
                   program_unanswered_ = false;
                   track_.on_started(started.name, out);
                 },
                 [&](const UrProgramStopped& stopped) { track_.on_stopped(stopped.name, now, out); },
                 [&](const UrText& text) { track_.on_text(text.text, out); },
                 [&](const UrException& raised) { on_exception(raised, out); },
                 [&](const UrError& error) { on_error(error, now, out); },
             },
             event);
}

void TcpTextDriver::on_error(const UrError& error, Now now, const DriverOut& out) {
  const std::string text = "C" + std::to_string(error.code) + "A" + std::to_string(error.argument) + " " + error.text;
  out.out.count("from_robot.error");
  out.out.log(error.level >= kWorthALine ? LogLevel::warning : LogLevel::debug, "robot_report", text);
  if (error.level < kWorthALine) return;
  last_error_ = text;
  last_error_at_ = now.mono;
  track_.on_error(text);
  // Anything worse than a warning stops the arm, which its state shows.
  if (error.level == kWorthALine) warn(text, now, out);
}

void TcpTextDriver::warn(const std::string& text, Now now, const DriverOut& out) {
  const Duration quiet = text == last_warning_ ? kQuiet : kWarningPause;
  if (warned_at_ && now.mono - *warned_at_ < quiet) return out.out.count("suppressed.warning");
  last_warning_ = text;
  warned_at_ = now.mono;
  out.emit(FaultSaid{"", Severity::warning, text});
}

void TcpTextDriver::on_state(const UrState& state, Now now, const DriverOut& out) {
  const bool before = online();
  heard_ = true;
  last_heard_ = last_state_ = now.mono;
  program_running_ = state.program_running;
  robot_mode_ = state.robot_mode;
  remember_state(state, now);
  if (!before && online()) out.emit(LinkUp{});
  report_safety(state.safety, now, out);
  if (const auto why = disabled(now)) track_.on_disabled(*why, out);
  look_at_halt(now, out);
  if (surely_idle()) confirm_stop(false, out);
  out.emit(ValuesHeard{});
}

void TcpTextDriver::remember_state(const UrState& state, Now now) {
  remember("robot_mode", {double(state.robot_mode)}, std::to_string(state.robot_mode), now);
  remember("safety", {double(state.safety)}, std::to_string(state.safety), now);
  remember("program_running", {double(state.program_running)}, state.program_running ? "true" : "false", now);
  remember("power", {double(state.power)}, state.power ? "true" : "false", now);
  remember("speed", {state.speed_fraction}, number_json(state.speed_fraction), now);
  if (state.reach) {
    reach_ = state.reach;
    remember("reach", {reach_->length}, number_json(reach_->length), now);
  }
  // What RTDE has measured meanwhile is newer.
  if (sampled_at_ && now.mono - *sampled_at_ < kHung) return;
  if (state.joints) remember_six("joints", *state.joints, now);
  if (state.tool) remember_six("tool", *state.tool, now);
}

void TcpTextDriver::on_data(BytesView bytes, Now now, const DriverOut& out) {
  Bytes answers;
  std::vector<UrSample> samples;
  const Status read = rtde_.add(bytes, samples, answers);
  if (!answers.empty()) out.robot.write(Channel::data, std::move(answers));
  if (!samples.empty()) {
    last_data_ = now.mono;
    sampled_at_ = now.mono;
    remember_six("joints", samples.back().joints, now);
    remember_six("tool", samples.back().tool, now);
    out.emit(ValuesHeard{});
  }
  if (!read) drop_data(read.error().what, out);
}

/// The joints are read from the monitor again, until the next connection.
void TcpTextDriver::drop_data(const std::string& reason, const DriverOut& out) {
  out.refuse("rtde", "the RTDE connection is closed: " + reason);
  out.robot.close(Channel::data, reason);
  data_up_ = false;
}

void TcpTextDriver::report_safety(int safety, Now now, const DriverOut& out) {
  const bool protective = safety == kUrSafetyProtectiveStop;
  const bool emergency = safety == kUrSafetyEmergencyStop;
  if (!protective && !emergency) out.emit(FaultOver{kSafety});
  if (safety == safety_) return;
  safety_ = safety;
  if (protective) out.emit(FaultSaid{"", Severity::critical, with_own_words("protective stop", now), kSafety});
  if (emergency) out.emit(FaultSaid{"", Severity::fatal, with_own_words("emergency stop", now), kSafety});
}

std::string TcpTextDriver::with_own_words(std::string text, Now now) const {
  if (!last_error_.empty() && now.mono - last_error_at_ <= kSameCause) text += ": " + last_error_;
  return text;
}

std::optional<Error> TcpTextDriver::disabled(Now now) const {
  constexpr std::string_view kRun = "set robotmode run";
  if (safety_ == kUrSafetyEmergencyStop) {
    return fail(Errc::robot_error, with_own_words("the robot is in emergency stop", now),
                "release the emergency stop at the robot, then " + how_to({"power on", kRun}));
  }
  if (safety_ == kUrSafetyProtectiveStop) {
    return fail(Errc::robot_error, with_own_words("the robot is in protective stop", now),
                "look what it ran into, then " + how_to({"set unlock protective stop"}));
  }
  if (robot_mode_ == kUrModePowerOff) {
    return fail(Errc::robot_error, "the arm is powered off", how_to({"power on", kRun}));
  }
  if (robot_mode_ == kUrModeIdle) return fail(Errc::robot_error, "the arm's brakes are on", how_to({kRun}));
  if (robot_mode_ == kUrModeRunning) return std::nullopt;
  return fail(Errc::robot_error, "the controller is in robot mode " + std::to_string(robot_mode_) + ", not running",
              "look at the robot's pendant");
}

std::string TcpTextDriver::how_to(std::initializer_list<std::string_view> words) const {
  std::string out;
  for (const std::string_view word : words) {
    for (const auto& [subtype, command] : commands_) {
      if (command.text != word) continue;
      out += (out.empty() ? "trb send " : ", trb send ") + own_id_ + " command " + subtype;
      break;
    }
  }
  return out.empty() ? "use the robot's pendant" : out;
}

void TcpTextDriver::remember_six(const std::string& name, const std::array<double, 6>& numbers, Now now) {
  remember(name, {numbers.begin(), numbers.end()}, joints_json(numbers), now);
}

void TcpTextDriver::remember(const std::string& name, std::vector<double> numbers, std::string json, Now now) {
  values_[name] = RobotValue{std::move(numbers), std::move(json), now.mono};
}

bool TcpTextDriver::surely_idle() const {
  return heard_ && track_.idle() && !program_running_ && last_state_ - last_write_ >= kStatePeriod;
}

void TcpTextDriver::drop_monitor(std::string_view counted, const std::string& reason, Now now, const DriverOut& out) {
  out.refuse(counted, "the monitor connection is closed: " + reason);
  out.robot.close(Channel::monitor, reason);
  on_down(Channel::monitor, reason, now, out);
}

void TcpTextDriver::tick(Now now, const DriverOut& out) {
  track_.tick(now, out);
  if (monitor_up_ && now.mono - last_heard_ >= kHung) drop_monitor("monitor_silent", "no state for 3 s", now, out);
  if (data_up_ && now.mono - last_data_ >= kHung) drop_data("no data for 3 s", out);
}

std::optional<MonotonicTime> TcpTextDriver::next_deadline() const {
  const auto hung = monitor_up_ ? std::optional(last_heard_ + kHung) : std::nullopt;
  const auto silent = data_up_ ? std::optional(last_data_ + kHung) : std::nullopt;
  return earlier(earlier(hung, silent), track_.next_deadline());
}

}  // namespace trb::drivers
