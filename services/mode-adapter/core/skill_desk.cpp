#include "services/mode-adapter/core/skill_desk.hpp"

#include <algorithm>
#include <cmath>

#include "common/drivers/lines/field_text.hpp"
#include "common/drivers/text/number_text.hpp"
#include "services/mode-adapter/core/same_number.hpp"
#include "services/mode-adapter/core/skill_call.hpp"

namespace trb::adapter {
namespace {

constexpr std::size_t kMaxReason = 1024;
constexpr std::size_t kMaxData = 65536;
// The name under which a robot sends its position; an arm may send its joints instead.
constexpr std::string_view kPosition = "position";
constexpr std::string_view kJoints = "joints";
/// A monitor's state that is read this long after the command's start certainly belongs to it.
constexpr Duration kStatePeriod = std::chrono::milliseconds(100);

/// Within it a robot that has a command shows another state, if it takes any time for it.
constexpr double kSettle_s = 2;

/// What was on its way when the link broke may still be heard after the halt was written, and delay the silence.
constexpr Duration kOnItsWay = std::chrono::seconds(1);

MonotonicTime has_halt_at(const Driver& mode, Now now) {
  return now.mono + mode.silence_bound() + kOnItsWay;
}

/// The robot's result as JSON text.
std::string as_json(const std::string& text) {
  if (text.empty() || parse_json(text)) return text;
  return dump_json(Value{text});
}

/// Refusals after which the attempt can still be made; after any other it has failed.
bool may_be_tried_again(Errc code) {
  return code == Errc::busy || code == Errc::queue_full || code == Errc::robot_offline ||
         code == Errc::no_field_channel;
}

/// Would no event report that the robot cannot finish? Then only its position or state shows the end.
bool ends_unseen(const SkillEnd& end) {
  return end.kind != EndKind::acknowledgement && !end.fails_at;
}

Error robot_offline() {
  return fail(Errc::robot_offline, "the robot is not connected", "look at its power, its network and its program");
}

}  // namespace

bool SkillDesk::execute(const Inbound& message, const Execute& order, const std::optional<Error>& barred, Now now,
                        Outbox& out) {
  const Settings& settings = robot_.settings;
  if (message.source != settings.id) {
    out.nack(message,
             fail(Errc::not_permitted, "only the node's own scheduler gives skills to the robot", "submit a scenario"));
    return false;
  }
  if (order.instance != settings.instance) {
    out.nack(message, fail(Errc::stale_instance, "the mode-adapter was restarted since", "ask for its state"));
    return false;
  }
  if (answer_known(message, order.key, out)) return false;
  if (const auto refused = barred ? barred : refusal(order)) {
    out.nack(message, *refused);
    return false;
  }
  return begin(message, order, now, out);
}

bool SkillDesk::answer_known(const Inbound& message, const AttemptKey& key, Outbox& out) {
  if (running_ && running_->key == key) {
    out.reply(message, ExecutionState{key, robot_.settings.instance, "running"});
    return true;
  }
  const Outcome* known = outcomes_.find(key);
  if (known == nullptr) return false;
  out.reply(message, *known);
  told_ = true;
  return true;
}

std::optional<Error> SkillDesk::refusal(const Execute& order) {
  if (running_) return fail(Errc::busy, "the robot carries out '" + running_->skill->name + "'", "wait for its end");
  if (busy()) return fail(Errc::busy, "the robot is halted: it may still do what was ended", "wait a moment");
  if (!outcomes_.make_room())
    return fail(Errc::busy, "too many outcomes wait to be journaled", "look at the scheduler");
  const Skill* skill = robot_.settings.description.find_skill(order.skill);
  const Driver& mode = skill == nullptr ? robot_.primary() : robot_.mode_for(MessageType::command, skill->subtype);
  if (!mode.online()) return robot_offline();
  return std::nullopt;
}

bool SkillDesk::begin(const Inbound& message, const Execute& order, Now now, Outbox& out) {
  const Skill* skill = robot_.settings.description.find_skill(order.skill);
  const Status begun = skill == nullptr ? Status(fail(Errc::unknown_skill, "the robot's description has no skill '" +
                                                                               order.skill.substr(0, 64) + "'"))
                                        : hand_over(order, *skill, now, out);
  if (begun) {
    out.reply(message, ExecutionState{order.key, robot_.settings.instance, "running"});
    return true;
  }
  if (may_be_tried_again(begun.error().code)) {
    out.nack(message, begun.error().code == Errc::no_field_channel ? robot_offline() : begun.error());
    return false;
  }
  Outcome outcome{order.key, robot_.settings.instance, TaskOutcome::failed, begun.error().text(), "", 0};
  outcome.reason.resize(std::min(outcome.reason.size(), kMaxReason));
  if (message.wants_answer()) out.reply(message, outcome);
  told_ = true;
  outcomes_.add(std::move(outcome), now);
  return false;
}

Status SkillDesk::hand_over(const Execute& order, const Skill& skill, Now now, Outbox& out) {
  const Settings& settings = robot_.settings;
  Driver& mode = robot_.mode_for(MessageType::command, skill.subtype);
  auto call = render_call(skill, order.data, settings.description, settings.places, robot_.style_for(mode));
  if (!call) return call.error();
  if (skill.end.kind == EndKind::acknowledgement && !mode.tells_end(skill.subtype)) {
    return fail(Errc::bad_value,
                "skill '" + skill.name + "' ends with an acknowledgement, which this command never gets",
                "give the robot a monitor and \"wrap\" in commands.json, or the skill another end");
  }
  const Token token = robot_.next_token();
  const auto progress = mode.hand_over(
      {token, MessageType::command, skill.subtype, settings.id, call->data, skill.name}, now, robot_.to(mode, out));
  if (!progress) return progress.error();
  const double timeout_s = order.timeout_s > 0 ? order.timeout_s : skill.timeout_s;
  running_ = Running{order.key, &skill,
                     token,     &mode,
                     now.mono,  now.mono + seconds(std::min(timeout_s, 1e8)),
                     timeout_s, std::move(call->target),
                     {},        {}};
  owed_.reset();
  if (*progress == Progress::handed_over) on_under_way(now);
  return Done{};
}

void SkillDesk::owe_halt(std::string_view skill, bool fenced, Now now, Outbox& out) {
  const Skill* known = robot_.settings.description.find_skill(skill);
  Driver& mode = known == nullptr ? robot_.primary() : robot_.mode_for(MessageType::command, known->subtype);
  owed_ = Owed{&mode, robot_.next_token()};
  if (mode.online()) on_link_up(mode, fenced, now, out);
}

void SkillDesk::cancel(const Inbound& message, const CancelExecution& order, bool fenced, Now now, Outbox& out) {
  if (message.source != robot_.settings.id) {
    return out.nack(message, fail(Errc::not_permitted, "only the node's own scheduler cancels skills", "use trb stop"));
  }
  const std::string reason = "cancelled: " + order.reason;
  if (running_ && running_->key == order.key) {
    halt(reason, now, out);
  } else if (outcomes_.find(order.key) == nullptr) {
    if (!outcomes_.make_room()) {
      return out.nack(message, fail(Errc::busy, "too many outcomes wait to be journaled", "look at the scheduler"));
    }
    keep({order.key, robot_.settings.instance, TaskOutcome::failed, reason, "", 0}, now, out);
    if (!order.begun.empty() && !running_) owe_halt(order.begun, fenced, now, out);
  }
  answer_known(message, order.key, out);
}

bool SkillDesk::query(const Inbound& message, const ExecutionQuery& query, Outbox& out) {
  if (answer_known(message, query.key, out)) return true;
  out.reply(message, ExecutionState{query.key, robot_.settings.instance, "unknown"});
  return false;
}

void SkillDesk::on_under_way(Now now) {
  if (!running_ || running_->under_way_at) return;
  running_->under_way_at = now.mono;
  if (!state_lags()) return;
  const std::string& name = running_->skill->end.state;
  const auto heard = heard_.find(name);
  if (heard != heard_.end() && heard->second.mode == running_->mode) running_->state = heard->second.number;
  const RobotValue* known = running_->mode->value(name);
  if (known != nullptr && !known->numbers.empty()) running_->state = known->numbers.front();
}

/// Also while nothing runs: the next skill's state is compared with it.
void SkillDesk::note_state(const Driver* mode, std::string_view name, const std::vector<double>& numbers) {
  const auto& skills = robot_.settings.description.skills;
  const bool ends_one = std::ranges::any_of(
      skills, [&](const Skill& skill) { return skill.end.kind == EndKind::state && skill.end.state == name; });
  if (ends_one && !numbers.empty()) heard_[std::string(name)] = {mode, numbers.front()};
}

void SkillDesk::on_ended(const Ended& ended, Now now, Outbox& out) {
  if (!ended.well) {
    return end(TaskOutcome::failed, running_->halting ? running_->halting->reason : ended.text, {}, now, out);
  }
  // A robot's `done` counts as the end only where the description says so: "arrived" may come before the position.
  if (running_->skill->end.kind == EndKind::acknowledgement) {
    end(TaskOutcome::finished, {}, as_json(ended.text), now, out);
  }
}

void SkillDesk::on_refused(const Error& error, Now now, Outbox& out) {
  const bool nobody_knows = error.code == Errc::robot_offline || error.code == Errc::timeout;
  if (nobody_knows) return interrupt(error.what, now, out);
  end(TaskOutcome::failed, running_->halting ? running_->halting->reason : error.what, {}, now, out);
}

void SkillDesk::on_halted(const Halted& halted, Now now, Outbox& out) {
  if (owed_ && owed_->token == halted.token) {
    owed_->until.reset();
    if (halted.well) owed_.reset();
  }
  if (!owns(halted.token) || !running_->halting) return;
  if (!halted.well) return interrupt(halted.text, now, out);
  end(TaskOutcome::failed, running_->halting->reason, {}, now, out);
}

bool SkillDesk::ends_by_value() const {
  if (!running_->under_way_at) return false;
  const EndKind kind = running_->skill->end.kind;
  // A robot that is halted may well come to the state of one that is done.
  return kind == EndKind::position || (kind == EndKind::state && !running_->halting);
}

void SkillDesk::on_values(const Driver* mode, Now now, Outbox& out) {
  if (!running_ || running_->mode != mode || !ends_by_value()) return;
  const SkillEnd& wanted = running_->skill->end;
  std::string_view name = wanted.state;
  if (name.empty()) name = mode->value(kPosition) != nullptr ? kPosition : kJoints;
  const RobotValue* value = mode->value(name);
  if (value == nullptr) return;
  if (state_lags()) {
    if (value->heard >= *running_->under_way_at) on_lagging_state(value->numbers, now, out);
    return;
  }
  if (value->heard - *running_->under_way_at < kStatePeriod) return;
  look_at(name, value->numbers, now, out);
}

void SkillDesk::on_information(const Driver* mode, std::string_view subtype, BytesView data, Now now, Outbox& out) {
  const auto numbers = read_numbers(data);
  if (!numbers) return;
  note_state(mode, subtype, *numbers);
  if (!running_ || running_->mode != mode || !ends_by_value()) return;
  if (!state_lags()) return look_at(subtype, *numbers, now, out);
  if (subtype == running_->skill->end.state) on_lagging_state(*numbers, now, out);
}

bool SkillDesk::state_lags() const {
  const Skill& skill = *running_->skill;
  return skill.end.kind == EndKind::state && running_->mode->values_lag(skill.subtype);
}

void SkillDesk::on_lagging_state(const std::vector<double>& numbers, Now now, Outbox& out) {
  if (numbers.empty()) return;
  Running& running = *running_;
  const bool changed = running.state && !same_number(*running.state, numbers.front());
  running.state = numbers.front();
  running.state_heard = true;
  // What is heard at once may be of the time before, also where it has changed.
  if (changed && now.mono - *running.under_way_at >= kStatePeriod) running.state_counts = true;
  if (running.state_counts) look_at(running.skill->end.state, numbers, now, out);
}

std::optional<MonotonicTime> SkillDesk::settled_at() const {
  if (!running_ || !running_->under_way_at || running_->state_counts || !ends_by_value() || !state_lags())
    return std::nullopt;
  return *running_->under_way_at + seconds(std::min(kSettle_s, running_->timeout_s / 2));
}

void SkillDesk::look_at(std::string_view name, const std::vector<double>& numbers, Now now, Outbox& out) {
  const SkillEnd& wanted = running_->skill->end;
  const auto& bad = wanted.fails_at;
  if (bad && name == wanted.state && !numbers.empty() && same_number(numbers.front(), *bad)) {
    return end(TaskOutcome::failed, "the robot's '" + wanted.state + "' says " + number_text(*bad), {}, now, out);
  }
  if (reached(name, numbers)) end(TaskOutcome::finished, {}, {}, now, out);
}

bool SkillDesk::reached(std::string_view name, const std::vector<double>& numbers) const {
  const SkillEnd& wanted = running_->skill->end;
  if (wanted.kind == EndKind::state) {
    return name == wanted.state && !numbers.empty() && same_number(numbers.front(), wanted.equals);
  }
  const auto& target = running_->target;
  const bool is_position = wanted.state.empty() ? name == kJoints || name == kPosition : name == wanted.state;
  if (wanted.kind != EndKind::position || !is_position) return false;
  if (target.empty() || numbers.size() < target.size()) return false;
  for (std::size_t i = 0; i < target.size(); ++i) {
    if (std::abs(numbers[i] - target[i]) > wanted.tolerance) return false;
  }
  return true;
}

void SkillDesk::on_fault(std::string_view capability, Severity severity, const std::string& text, Now now,
                         Outbox& out) {
  if (!running_ || severity < Severity::critical || running_->skill->capability != capability) return;
  if (ends_unseen(running_->skill->end)) halt(text, now, out);
}

void SkillDesk::on_link_up(Driver& mode, bool fenced, Now now, Outbox& out) {
  if (!owed_ || owed_->mode != &mode || fenced) return;
  owed_->until = has_halt_at(mode, now);
  mode.halt(owed_->token, now, robot_.to(mode, out));
}

void SkillDesk::on_link_down(const Driver* mode, const std::string& reason, Now now, Outbox& out) {
  if (running_ && running_->mode == mode) interrupt("the robot's connection was lost: " + reason, now, out);
  if (owed_ && owed_->mode == mode) owed_->until.reset();
  std::erase_if(heard_, [&](const auto& entry) { return entry.second.mode == mode; });
}

void SkillDesk::on_stopped(const Driver* mode) {
  if (owed_ && owed_->mode == mode) owed_.reset();
}

void SkillDesk::interrupt(const std::string& reason, Now now, Outbox& out) {
  if (!running_) return;
  // It may go on with it: whatever comes next would find it in motion.
  owed_ = Owed{running_->mode, running_->token};
  const std::string before =
      running_->halting ? running_->halting->reason + ", and nobody knows whether the robot was halted: " : "";
  end(TaskOutcome::interrupted, before + reason, {}, now, out);
}

std::optional<MonotonicTime> SkillDesk::timed_end() const {
  if (!running_ || running_->halting || !running_->under_way_at) return std::nullopt;
  if (running_->skill->end.kind != EndKind::time) return std::nullopt;
  return *running_->under_way_at + seconds(running_->skill->end.duration_s);
}

void SkillDesk::halt(const std::string& reason, Now now, Outbox& out) {
  if (running_->halting) return;
  Driver& mode = *running_->mode;
  running_->halting = Halting{reason, has_halt_at(mode, now)};
  mode.halt(running_->token, now, robot_.to(mode, out));
}

std::optional<MonotonicTime> SkillDesk::limit() const {
  if (running_) return running_->halting ? running_->halting->until : running_->deadline;
  return owed_ ? owed_->until : std::nullopt;
}

void SkillDesk::end(TaskOutcome outcome, const std::string& reason, std::string data, Now now, Outbox& out) {
  if (data.size() > kMaxData) data.clear();
  const double duration_s = to_seconds(now.mono - running_->began);
  Outcome ended{running_->key, robot_.settings.instance, outcome, reason.substr(0, kMaxReason), std::move(data),
                duration_s};
  running_.reset();
  keep(std::move(ended), now, out);
}

void SkillDesk::keep(Outcome outcome, Now now, Outbox& out) {
  out.information(robot_.settings.id, outcome);
  told_ = true;
  outcomes_.add(std::move(outcome), now);
}

void SkillDesk::tick(Now now, Outbox& out) {
  if (const auto timed = timed_end(); timed && now.mono >= *timed) end(TaskOutcome::finished, {}, {}, now, out);
  if (const auto at = settled_at(); at && now.mono >= *at) {
    running_->state_counts = true;
    if (running_->state_heard) look_at(running_->skill->end.state, {*running_->state}, now, out);
  }
  if (const auto at = limit(); at && now.mono >= *at) on_limit(now, out);
  told_ |= outcomes_.resend(now, [&](const Outcome& outcome) { out.information(robot_.settings.id, outcome); });
}

void SkillDesk::on_limit(Now now, Outbox& out) {
  if (!running_) return owed_.reset();
  if (running_->halting) return end(TaskOutcome::failed, running_->halting->reason, {}, now, out);
  halt("timed out after " + number_text(running_->timeout_s) + " s", now, out);
}

std::optional<MonotonicTime> SkillDesk::next_deadline() const {
  return earlier(earlier(limit(), settled_at()), earlier(timed_end(), outcomes_.next_deadline()));
}

}  // namespace trb::adapter
