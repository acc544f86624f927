#include "services/mode-adapter/core/hand_drive.hpp"

#include <algorithm>
#include <cmath>

#include "services/mode-adapter/core/skill_call.hpp"

namespace trb::adapter {
namespace {

/// A late message of a drive is no older than its deadline, 10 s: no page begins more drives in that time.
constexpr std::size_t kMaxOver = 256;
constexpr const char* kLetGo = "let go, and begin another drive";

std::string axes_of(const Drive& drive) {
  std::string names;
  for (const DriveAxis& axis : drive.axes) names += (names.empty() ? "" : ", ") + axis.name;
  return names;
}

Error no_such_part(DrivePart part, const Description& description) {
  std::string parts;
  for (const Drive& drive : description.drives) parts += (parts.empty() ? "" : ", ") + std::string(name_of(drive.part));
  return fail(Errc::bad_value, "part: the robot has no '" + std::string(name_of(part)) + "' that can be driven",
              parts.empty() ? "its description has no \"drives\"" : "use one of: " + parts);
}

/// The speeds within the limits, as a skill's parameters: missing ones are 0.
std::string parameters_of(const Drive& drive, const std::vector<double>& speeds) {
  Value::Object parameters;
  for (std::size_t i = 0; i < drive.axes.size(); ++i) {
    const DriveAxis& axis = drive.axes[i];
    const double wanted = i < speeds.size() ? speeds[i] : 0;
    const double speed = std::clamp(wanted, axis.one_way ? 0 : -axis.limit, axis.limit) * axis.factor.value_or(1);
    parameters.emplace_back(axis.name, Value{speed == 0 ? 0.0 : speed});  // never -0
  }
  return dump_json(Value{std::move(parameters)});
}

Result<Bytes> words_of(const Skill& skill, const std::string& parameters, const RobotSide& robot, const Driver& mode) {
  auto call = render_call(skill, parameters, robot.settings.description, robot.settings.places, robot.style_for(mode));
  if (!call) return call.error();
  return std::move(call->data);
}

Result<Progress> hand_over_stand(const Drive& drive, Token token, RobotSide& robot, Now now, Outbox& out) {
  const Skill& skill = drive.stand ? *drive.stand : drive.command;
  Driver& mode = robot.mode_for(MessageType::command, skill.subtype);
  const auto data = words_of(skill, drive.stand ? std::string() : parameters_of(drive, {}), robot, mode);
  if (!data) return data.error();
  return mode.hand_over({token, MessageType::command, skill.subtype, robot.settings.id, *data, {}}, now,
                        robot.to(mode, out));
}

/// `conflict` is this class's own word: a client takes it for the end of its drive.
Error of_robot(Error error) {
  if (error.code == Errc::conflict) error.code = Errc::robot_error;
  if (error.code == Errc::no_field_channel) error.code = Errc::robot_offline;
  return error;
}

}  // namespace

bool HandDrive::owns(Token token) const {
  return (current_ && current_->leaving == token) || (standing_ && standing_->token == token);
}

bool HandDrive::is_current(const Inbound& message, const Velocity& velocity) const {
  return current_ && current_->source == message.source && current_->number == velocity.drive;
}

const HandDrive::Over* HandDrive::find_over(const std::string& source, std::uint64_t number) const {
  const auto at =
      std::ranges::find_if(over_, [&](const Over& over) { return over.number == number && over.source == source; });
  return at == over_.end() ? nullptr : &*at;
}

void HandDrive::on_velocity(const Inbound& message, const Velocity& velocity, Now now, Outbox& out) {
  Status done = Done{};
  if (const Over* over = find_over(message.source, velocity.drive)) {
    done = fail(Errc::conflict, "drive: this one is over: " + over->reason, "begin another drive, with a new number");
  } else if (velocity.over) {
    return let_go(message, velocity, now, out);
  } else if (message.remaining_ms == 0) {
    done = fail(Errc::expired, "its deadline had passed when it came to the robot's node");
  } else {
    done = drive(message, velocity, now, out);
  }
  if (done) return out.reply(message, Ack{"driving", ""});
  out.count("refused." + std::string(errc_name(done.error().code)));
  out.nack(message, done.error());
}

void HandDrive::let_go(const Inbound& message, const Velocity& velocity, Now now, Outbox& out) {
  if (is_current(message, velocity)) {
    give_way("the person let go", now, out);
  } else {
    remember_over(message.source, velocity.drive, "the person let go before it began");
  }
  out.reply(message, Ack{"over", ""});
}

Status HandDrive::drive(const Inbound& message, const Velocity& velocity, Now now, Outbox& out) {
  if (Status good = check_speeds(velocity); !good) return good;
  if (Status good = check_control(message, velocity, now); !good) return good;
  const Holder by{Holder::Kind::person, message.source};
  // An explicit takeover holds even if the robot refuses: its sender wants the former holder silenced.
  if (velocity.take && !is_current(message, velocity)) {
    give_way("'" + message.source + "' has taken it over", now, out);
    control_.take(by, now, out);
  }
  const Drive& part = *robot_.settings.description.find_drive(velocity.part);
  const bool begins = !current_;
  Status done = check_robot(part);
  Driver& mode = robot_.mode_for(MessageType::command, part.command.subtype);
  if (done) {
    Current next = begins ? Current{message.source, velocity.drive, velocity.by, &part, &mode, 0, {}, false, 0, {}, {}}
                          : *current_;
    auto words = words_of(part.command, parameters_of(part, velocity.speeds), robot_, mode);
    done = words ? Status(Done{}) : Status(words.error());
    if (done && next.leaving != 0) {
      next.next = std::move(*words);
    } else if (done) {
      done = hand_over(next, *words, now, out);
    }
    next.sequence = velocity.sequence;
    next.last = now.mono;
    next.moves = std::ranges::any_of(velocity.speeds, [](double speed) { return speed != 0; });
    if (done) current_ = std::move(next);
  }
  if (!done) {
    const Error error = of_robot(done.error());
    if (!begins) give_way("the robot takes no more speeds: " + error.what, now, out);
    return error;
  }
  control_.take(by, now, out);
  standing_.reset();  // they take the place of the order to stand
  if (!begins) return Done{};
  out.count("drives");
  out.log(LogLevel::info, "drive_began",
          "'" + velocity.by + "' at '" + message.source + "' drives " + std::string(name_of(velocity.part)));
  return Done{};
}

Status HandDrive::check_speeds(const Velocity& velocity) const {
  const Drive* part = robot_.settings.description.find_drive(velocity.part);
  if (part == nullptr) return no_such_part(velocity.part, robot_.settings.description);
  if (velocity.speeds.size() > part->axes.size()) {
    return fail(Errc::bad_value,
                "speeds: " + std::to_string(velocity.speeds.size()) + " of them, and '" +
                    std::string(name_of(velocity.part)) + "' has " + std::to_string(part->axes.size()) + " axes",
                "give at most one for each of: " + axes_of(*part));
  }
  for (std::size_t i = 0; i < velocity.speeds.size(); ++i) {
    if (std::isfinite(velocity.speeds[i])) continue;
    return fail(Errc::bad_value, "speeds[" + std::to_string(i) + "]: is no finite number", "give m/s or rad/s");
  }
  return Done{};
}

Status HandDrive::check_control(const Inbound& message, const Velocity& velocity, Now now) const {
  const std::string& id = robot_.settings.id;
  if (auto barred = control_.barred({Holder::Kind::person, message.source}, velocity.take, now)) {
    if (barred->code == Errc::control_held) {
      barred->hint = "wait until it is free, or take it over: trb drive " + id + " --take (\"take\" in the API)";
    }
    return *barred;
  }
  if (!current_) return Done{};
  if (!is_current(message, velocity)) {
    if (velocity.take) return Done{};
    return fail(Errc::control_held, "'" + current_->by + "' at '" + current_->source + "' drives " + id + " by hand",
                "wait for its end, or take it over: trb drive " + id + " --take (\"take\" in the API)");
  }
  if (velocity.sequence <= current_->sequence) {
    return fail(
        Errc::conflict,
        "sequence: " + std::to_string(velocity.sequence) + " is not newer than " + std::to_string(current_->sequence),
        "count up within a drive");
  }
  if (velocity.part == current_->drive->part) return Done{};
  return fail(Errc::bad_value, "part: this drive moves '" + std::string(name_of(current_->drive->part)) + "'", kLetGo);
}

Status HandDrive::check_robot(const Drive& drive) {
  if (!robot_.mode_for(MessageType::command, drive.command.subtype).online()) {
    return fail(Errc::robot_offline, "the robot is not connected", "look at its power, its network and its program");
  }
  if (const auto out_of_use = faults_.refusal(drive.command.capability)) return *out_of_use;
  if (desk_.busy()) return fail(Errc::busy, "the robot carries out a skill", "wait for its end, or stop the robot");
  return Done{};
}

Status HandDrive::hand_over(Current& current, const Bytes& data, Now now, Outbox& out) {
  const Token token = robot_.next_token();
  const Handover message{token, MessageType::command, current.drive->command.subtype, current.source, data, {}};
  const auto progress = current.mode->hand_over(message, now, robot_.to(*current.mode, out));
  if (!progress) return progress.error();
  current.leaving = *progress == Progress::queued ? token : 0;
  current.leaving_at = now.mono;
  return Done{};
}

void HandDrive::on_under_way(Token token, Now now, Outbox& out) {
  if (standing_ && standing_->token == token) return standing_.reset();
  if (!current_ || current_->leaving != token) return;
  current_->leaving = 0;
  const auto newest = std::exchange(current_->next, std::nullopt);
  if (!newest) return;
  const Status done = hand_over(*current_, *newest, now, out);
  if (!done) give_way("the robot takes no more speeds: " + done.error().what, now, out);
}

void HandDrive::on_refused(const Refused& refused, Now now, Outbox& out) {
  if (current_ && current_->leaving == refused.token) {
    current_->leaving = 0;
    out.count("refused." + std::string(errc_name(refused.error.code)));
    return give_way("the robot refuses: " + refused.error.what, now, out);
  }
  if (!standing_ || standing_->token != refused.token) return;
  Driver& mode = *standing_->mode;
  standing_->token = 0;
  if (!mode.online()) return;
  out.log(LogLevel::warning, "not_told_to_stand", refused.error.text());
  standing_.reset();
  mode.halt(refused.token, now, robot_.to(mode, out));
}

void HandDrive::on_link_up(Driver& mode, Now now, Outbox& out) {
  if (!standing_ || standing_->mode != &mode || standing_->token != 0 || control_.fenced()) return;
  stand(*standing_->drive, mode, now, out);
}

void HandDrive::on_link_down(const Driver& mode, const std::string& reason, Outbox& out) {
  if (standing_ && standing_->mode == &mode) standing_->token = 0;
  if (!current_ || current_->mode != &mode) return;
  standing_ = Standing{current_->drive, current_->mode, 0};
  end("the robot's connection was lost: " + reason, out);
}

std::optional<Error> HandDrive::on_command(const Inbound& message, Now now, Outbox& out) {
  if (!current_ || message.type != MessageType::command) return std::nullopt;
  if ((message.flags & kFlagTakeControl) != 0) {
    give_way("'" + message.source + "' has taken control", now, out);
    return std::nullopt;
  }
  // Another node is refused by the lease.
  if (current_->source != message.source) return std::nullopt;
  return fail(Errc::busy, "'" + current_->by + "' drives the robot by hand", "let go first, or send it with --take");
}

void HandDrive::on_stop(const std::string& reason, Outbox& out) {
  // The stop takes the place of the order to stand, but it may be lost with the link.
  if (standing_) standing_->token = 0;
  if (!current_) return;
  standing_ = Standing{current_->drive, current_->mode, 0};
  end(reason, out);
}

void HandDrive::on_stopped(const Driver& mode) {
  if (standing_ && standing_->mode == &mode && standing_->token == 0) standing_.reset();
}

void HandDrive::give_way(const std::string& reason, Now now, Outbox& out) {
  if (!current_) return;
  const Current ended = *current_;
  end(reason, out);
  stand_of(ended, now, out);
}

void HandDrive::stand_of(const Current& drive, Now now, Outbox& out) {
  if (drive.leaving != 0) drive.mode->forget(drive.leaving, now, robot_.to(*drive.mode, out));
  stand(*drive.drive, *drive.mode, now, out);
}

void HandDrive::look_at_faults(Now now, Outbox& out) {
  if (!current_) return;
  if (const auto error = faults_.refusal(current_->drive->command.capability)) give_way(error->what, now, out);
}

void HandDrive::stand(const Drive& drive, Driver& mode, Now now, Outbox& out) {
  standing_ = Standing{&drive, &mode, 0};
  if (!mode.online()) return;
  const Token token = robot_.next_token();
  const auto progress = hand_over_stand(drive, token, robot_, now, out);
  if (!progress) {
    out.log(LogLevel::warning, "not_told_to_stand", progress.error().text());
    standing_.reset();
    return mode.halt(token, now, robot_.to(mode, out));
  }
  standing_->token = token;
  if (*progress == Progress::handed_over) standing_.reset();
}

void HandDrive::end(const std::string& reason, Outbox& out) {
  Current ended = std::move(*current_);
  current_.reset();
  out.log(LogLevel::info, "drive_over", "of '" + ended.by + "' at '" + ended.source + "': " + reason);
  control_.give_up({Holder::Kind::person, ended.source});
  remember_over(std::move(ended.source), ended.number, reason);
}

void HandDrive::remember_over(std::string source, std::uint64_t number, std::string reason) {
  over_.push_back({std::move(source), number, std::move(reason)});
  if (over_.size() > kMaxOver) over_.pop_front();
}

void HandDrive::tick(Now now, Outbox& out) {
  if (!current_) return;
  if (now.mono - current_->last >= kLasts) {
    return give_way("nothing more was heard for 500 ms", now, out);
  }
  if (current_->leaving != 0 && now.mono - current_->leaving_at >= kLasts) {
    return give_way("the robot has not taken its speeds for 500 ms", now, out);
  }
  if (!current_->moves || now.mono - current_->last < kCounts) return;
  out.count("drives.dead_man");
  stand_of(*current_, now, out);
  current_->moves = false;
  current_->leaving = 0;
  current_->next.reset();
}

std::optional<MonotonicTime> HandDrive::next_deadline() const {
  if (!current_) return std::nullopt;
  const MonotonicTime ceased = current_->last + (current_->moves ? kCounts : kLasts);
  return current_->leaving == 0 ? ceased : std::min(ceased, current_->leaving_at + kLasts);
}

}  // namespace trb::adapter
