#include "common/drivers/ros/driver.hpp"

#include <algorithm>

#include "proto/value.hpp"

namespace trb::drivers {
namespace {

/// The bridge sends its state every second.
constexpr Duration kSilent = std::chrono::seconds(4);
/// A value of the robot's that comes so long after a halt was published shows that the way to it was not lost.
constexpr Duration kHaltHeard = std::chrono::milliseconds(500);
constexpr std::ptrdiff_t kMaxPending = 64;
constexpr std::string_view kPosition = "position";
/// A publication waits so long for a subscriber, or shorter, if its sender does.
constexpr double kPatience_s = 5;
/// Each of the calls to the ROS master on its way may block the bridge's worker for 5 s: it is better late than never.
constexpr double kStopPatience_s = 20;
/// A watch that has failed is ordered again after a pause, which doubles from failure to failure.
constexpr Duration kFirstPause = std::chrono::seconds(1);
constexpr Duration kLongestPause = std::chrono::seconds(30);
/// That a value is unknown is logged once in so long.
constexpr Duration kQuiet = std::chrono::seconds(60);

Error error_of(const BridgeEvent& event) {
  return {errc_of(event.code).value_or(Errc::robot_error), event.what, event.hint};
}

/// Was all of it measured (no null)?
bool is_measured(const Value& value) {
  return !value.is_null() && !(value.is_list() && std::ranges::any_of(value.list(), &Value::is_null));
}

std::vector<double> numbers_of(const Value& value) {
  std::vector<double> numbers;
  const auto take = [&](const Value& item) {
    if (item.is_number()) numbers.push_back(item.number());
    if (item.is_bool()) numbers.push_back(item.boolean() ? 1 : 0);
  };
  if (value.is_list()) {
    for (const Value& item : value.list()) take(item);
  } else {
    take(value);
  }
  return numbers;
}

/// Is the value of that name the end of this skill?
bool ends_by(const SkillEnd& end, const std::string& name) {
  if (end.kind == EndKind::position && end.state.empty()) return name == kPosition;
  return (end.kind == EndKind::state || end.kind == EndKind::position) && name == end.state;
}

/// Does an end, a fault or a sensor need the value of that name?
bool is_watched(const Description& description, const std::string& name) {
  return std::ranges::any_of(description.skills, [&](const Skill& skill) { return ends_by(skill.end, name); }) ||
         std::ranges::find(description.faults, name, &FaultRule::value) != description.faults.end() ||
         std::ranges::find(description.sensors, name) != description.sensors.end();
}

}  // namespace

RosDriver::RosDriver(const DriverSettings& settings, const RosCommands& commands)
    : CommandsDriver(settings.id, settings.commands), instance_(settings.instance) {
  for (const auto& [subtype, words] : commands.commands) {
    auto& publications = commands_[subtype];
    for (const RosPublication& one : words) publications.push_back({one.topic, one.type, VendorTemplate(one.data)});
  }
  for (const auto& [subtype, question] : commands.requests) {
    questions_.emplace(subtype, Question{question, is_watched(settings.description, subtype)});
  }
}

Result<std::vector<BridgeCommand>> RosDriver::fill(std::string_view subtype, BytesView data) const {
  std::vector<BridgeCommand> out;
  const auto found = commands_.find(subtype);
  if (found == commands_.end()) return fail(Errc::unknown_subtype, "commands.json has no such command");
  for (const RosMessage& publication : found->second) {
    auto json = publication.data.fill(data, json_literal);
    if (!json) return json.error();
    BridgeCommand command;
    command.name = publication.topic;
    command.type = publication.type;
    command.data = std::move(*json);
    command.timeout_s = kPatience_s;
    out.push_back(std::move(command));
  }
  return out;
}

std::uint64_t RosDriver::send(std::vector<BridgeCommand> commands, Pending pending, const DriverOut& out) {
  const std::uint64_t key = ++last_key_;
  pending.left = commands.size();
  for (BridgeCommand& command : commands) {
    command.instance = instance_;
    command.token = key;
    out.out.command(own_id_, std::move(command));
  }
  pending_.emplace(key, std::move(pending));
  return key;
}

std::uint64_t RosDriver::ask(const Question& question, BridgeAction action, Pending pending, const DriverOut& out) {
  BridgeCommand command;
  command.action = action;
  command.name = question.words.topic;
  command.paths = question.words.fields;
  return send({std::move(command)}, std::move(pending), out);
}

Result<Progress> RosDriver::hand_over(const Handover& message, Now, const DriverOut& out) {
  if (!up_) {
    return fail(Errc::robot_offline, "ROS is not there", "look at trb service list and at the robot's ROS master");
  }
  // Each kind has its own places: a request waits for the topic's next message, a command must not wait for requests.
  const Purpose purpose = message.type == MessageType::request ? Purpose::request : Purpose::command;
  const auto waits = [purpose](const auto& entry) { return entry.second.purpose == purpose; };
  if (std::ranges::count_if(pending_, waits) >= kMaxPending) {
    return fail(Errc::queue_full, "too many messages wait for ROS", "send fewer");
  }
  const std::string subtype(message.subtype);
  if (message.type == MessageType::request) {
    const auto question = questions_.find(message.subtype);
    if (question == questions_.end()) return fail(Errc::unknown_subtype, "commands.json has no such request");
    out.out.count("to_robot." + subtype);
    ask(question->second, BridgeAction::ask, {Purpose::request, message.token, subtype, std::string(message.source), 0},
        out);
    return Progress::queued;
  }
  auto commands = fill(message.subtype, message.data);
  if (!commands) return commands.error();
  if (message.patience_s > 0) {
    for (BridgeCommand& command : *commands) command.timeout_s = std::min(message.patience_s, kPatience_s);
  }
  out.out.count("to_robot." + subtype);
  send(std::move(*commands), {Purpose::command, message.token, subtype, std::string(message.source), 0}, out);
  return Progress::queued;
}

/// It may wait at the bridge for its type or a subscriber: nobody would expect that it is published later.
void RosDriver::drop_at_bridge(std::uint64_t key, const DriverOut& out) const {
  BridgeCommand command;
  command.instance = instance_;
  command.token = key;
  command.action = BridgeAction::unwatch;
  out.out.command(own_id_, std::move(command));
}

void RosDriver::drop_all(Purpose purpose, const DriverOut& out) {
  std::erase_if(pending_, [&](const auto& entry) {
    if (entry.second.purpose != purpose) return false;
    drop_at_bridge(entry.first, out);
    return true;
  });
}

void RosDriver::forget(Token token, Now, const DriverOut& out) {
  const auto at = std::ranges::find_if(pending_, [&](const auto& entry) {
    const Pending& pending = entry.second;
    return pending.token == token && (pending.purpose == Purpose::command || pending.purpose == Purpose::request);
  });
  if (at == pending_.end()) return;
  drop_at_bridge(at->first, out);
  pending_.erase(at);
}

void RosDriver::halt(Token token, Now now, const DriverOut& out) {
  forget(token, now, out);
  if (!up_) return;
  auto commands = fill("stop", {});
  if (!commands || commands->empty()) return refuse_halt(token, out);
  out.out.count("to_robot.stop");
  send(std::move(*commands), {Purpose::halt, token, "stop", {}, 0}, out);
}

Result<Token> RosDriver::stop(Now, const DriverOut& out) {
  for (const auto& [key, pending] : pending_) {
    if (pending.purpose != Purpose::command) continue;
    out.emit(Refused{pending.token, fail(Errc::fenced, "the robot was stopped before it took this message",
                                         "trb release " + own_id_)});
  }
  drop_all(Purpose::command, out);
  drop_all(Purpose::release, out);
  if (!up_) return fail(Errc::robot_offline, "ROS is not there");
  auto commands = fill("stop", {});
  if (!commands) return fail(Errc::unknown_subtype, "commands.json has no \"stop\" for this robot");
  for (BridgeCommand& command : *commands) command.timeout_s = kStopPatience_s;
  may_be_stopped_ = true;
  out.out.count("to_robot.stop");
  send(std::move(*commands), {Purpose::stop, ++last_ticket_, "stop", {}, 0}, out);
  return last_ticket_;
}

Result<Token> RosDriver::release(Now, const DriverOut& out) {
  if (!up_) return fail(Errc::robot_offline, "ROS is not there");
  may_be_stopped_ = false;
  drop_all(Purpose::stop, out);
  const Token ticket = ++last_ticket_;
  auto commands = fill("release", {});
  if (!commands || commands->empty()) {
    out.emit(Released{ticket});
    return ticket;
  }
  out.out.count("to_robot.release");
  send(std::move(*commands), {Purpose::release, ticket, "release", {}, 0}, out);
  return ticket;
}

void RosDriver::on_bridge(const BridgeEvent& event, Now now, const DriverOut& out) {
  const auto at = event.instance == instance_ ? pending_.find(event.token) : pending_.end();
  if (at == pending_.end()) return out.out.count("from_robot.late");
  if (event.result == BridgeResult::failed) return on_failed(event.token, at->second, event, now, out);
  if (event.result == BridgeResult::done) return on_done(event.token, at->second, now, out);
  const Pending pending = at->second;
  if (pending.purpose != Purpose::watch) pending_.erase(at);
  on_value(pending, event, now, out);
}

void RosDriver::on_value(const Pending& pending, const BridgeEvent& event, Now now, const DriverOut& out) {
  if (pending.purpose == Purpose::request) {
    out.out.count("from_robot." + pending.subtype);
    return out.emit(Said{MessageType::information, pending.subtype, pending.source, event.data});
  }
  if (pending.purpose != Purpose::watch) return;
  if (event.data.empty()) {
    lose_value(pending.subtype, event, now, out);
  } else {
    questions_.find(pending.subtype)->second.pause = {};
    keep_value(pending.subtype, event.data, now);
    out.emit(ValuesHeard{});
  }
  if (halting_ && now.mono - halting_->at >= kHaltHeard) {
    out.emit(Halted{std::exchange(halting_, std::nullopt)->token});
  }
}

/// Without its nulls a list's other numbers would stand in their place, and "not measured" is not "over".
void RosDriver::keep_value(const std::string& subtype, const std::string& data, Now now) {
  const auto value = parse_json(data);
  if (value && !is_measured(*value)) {
    values_.erase(subtype);
  } else {
    values_[subtype] = RobotValue{value ? numbers_of(*value) : std::vector<double>{}, data, now.mono};
  }
}

/// What the robot has said last is not known: neither is it what it said before. A fault stays as it was.
void RosDriver::lose_value(const std::string& subtype, const BridgeEvent& event, Now now, const DriverOut& out) {
  values_.erase(subtype);
  Question& question = questions_.find(subtype)->second;
  if (now.mono < question.quiet_until) return out.out.count("refused.bridge");
  question.quiet_until = now.mono + kQuiet;
  out.refuse("bridge", "'" + subtype + "' is unknown: " + error_of(event).text());
}

void RosDriver::on_done(std::uint64_t key, Pending& pending, Now now, const DriverOut& out) {
  if (pending.left > 1) {
    --pending.left;
    return;
  }
  const Pending ended = pending;
  pending_.erase(key);
  if (ended.refused) return;
  if (ended.purpose == Purpose::command) out.emit(HandedOver{ended.token});
  // ROS does not report that a robot stands still: the stop was only sent.
  if (ended.purpose == Purpose::stop) out.emit(Stopped{ended.token, false});
  if (ended.purpose == Purpose::halt) halting_ = Halting{ended.token, now.mono};
  if (ended.purpose == Purpose::release) out.emit(Released{ended.token});
}

void RosDriver::on_failed(std::uint64_t key, Pending& at_bridge, const BridgeEvent& event, Now now,
                          const DriverOut& out) {
  const Error error = error_of(event);
  const Pending pending = at_bridge;
  const bool stops = pending.purpose == Purpose::stop || pending.purpose == Purpose::halt;
  if (stops && pending.left > 1) {
    --at_bridge.left;  // the others stop what they can
    at_bridge.refused = true;
  } else {
    if (pending.left > 1) drop_at_bridge(key, out);
    pending_.erase(key);
  }
  if (pending.refused) return out.refuse("bridge", pending.subtype + ": " + error.text());
  if (pending.purpose == Purpose::command || pending.purpose == Purpose::request) {
    return out.emit(Refused{pending.token, error});
  }
  if (pending.purpose == Purpose::watch) {
    Question& question = questions_.find(pending.subtype)->second;
    question.watch = 0;
    question.pause = std::clamp(2 * question.pause, kFirstPause, kLongestPause);
    question.again = now.mono + question.pause;
    return lose_value(pending.subtype, event, now, out);
  }
  if (pending.purpose == Purpose::halt) out.emit(Halted{pending.token, false, error.what});
  // A stop or release that nothing received stays unanswered: its requester is notified at its deadline.
  out.refuse("bridge", pending.subtype + ": " + error.text());
}

void RosDriver::on_bridge(const BridgeState& state, Now now, const DriverOut& out) {
  heard_ = now.mono;
  if (up_ && (!state.up || state.connection != connection_)) {
    go_down(state.detail.empty() ? "the ROS bridge has started anew" : state.detail, out);
  }
  if (up_ || !state.up) return;
  up_ = true;
  connection_ = state.connection;
  // What is still wanted of them is given again now; it must not follow a later release.
  for (const std::uint64_t key : std::exchange(late_stops_, {})) drop_at_bridge(key, out);
  watch_all(out);
  out.emit(LinkUp{});
}

void RosDriver::watch_all(const DriverOut& out) {
  for (const auto& [subtype, question] : questions_) {
    if (question.always) watch(subtype, out);
  }
}

void RosDriver::watch_again(Now now, const DriverOut& out) {
  for (const auto& [subtype, question] : questions_) {
    if (question.again && now.mono >= *question.again) watch(subtype, out);
  }
}

void RosDriver::watch(std::string_view subtype, const DriverOut& out) {
  const auto at = questions_.find(subtype);
  if (!up_ || at == questions_.end() || at->second.watch != 0) return;
  at->second.again.reset();
  at->second.watch = ask(at->second, BridgeAction::watch, {Purpose::watch, 0, at->first, {}, 0}, out);
}

void RosDriver::unwatch(std::string_view subtype, const DriverOut& out) {
  const auto at = questions_.find(subtype);
  if (!up_ || at == questions_.end() || at->second.always) return;
  at->second.again.reset();
  if (at->second.watch == 0) return;
  const std::uint64_t key = std::exchange(at->second.watch, 0);
  pending_.erase(key);
  values_.erase(at->first);
  drop_at_bridge(key, out);
}

void RosDriver::go_down(const std::string& reason, const DriverOut& out) {
  up_ = false;
  halting_.reset();
  values_.clear();
  for (auto& [subtype, question] : questions_) {
    question.watch = 0;
    question.again.reset();
  }
  for (const auto& [key, pending] : std::exchange(pending_, {})) {
    if (pending.purpose != Purpose::command && pending.purpose != Purpose::request) continue;
    out.emit(Refused{pending.token, fail(Errc::robot_offline, "the way to ROS was lost: " + reason,
                                         "look at trb service list and at the robot's ROS master")});
  }
  out.emit(LinkDown{reason});
}

void RosDriver::tick(Now now, const DriverOut& out) {
  if (!up_) return;
  if (now.mono - heard_ < kSilent) return watch_again(now, out);
  // One that was only slow still has all that is forgotten here. A stop is better late than never.
  for (const auto& [key, pending] : pending_) {
    const bool stops = pending.purpose == Purpose::stop || pending.purpose == Purpose::halt;
    stops ? late_stops_.push_back(key) : drop_at_bridge(key, out);
  }
  go_down("the ROS bridge has said nothing for 4 s", out);
}

std::optional<MonotonicTime> RosDriver::next_deadline() const {
  if (!up_) return std::nullopt;
  std::optional<MonotonicTime> next = heard_ + kSilent;
  for (const auto& [subtype, question] : questions_) next = earlier(next, question.again);
  return next;
}

}  // namespace trb::drivers
