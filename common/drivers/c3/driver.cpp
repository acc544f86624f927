#include "common/drivers/c3/driver.hpp"

#include "common/drivers/c3/krl.hpp"

namespace trb::drivers {
namespace {

Error offline() {
  return fail(Errc::robot_offline, "the robot's C3 server is not connected",
              "look at the robot's power and network, and whether its C3 server runs on port 7000");
}

C3Jobs::Commands words_of(const C3Commands& commands) {
  C3Jobs::Commands words;
  for (const auto& [subtype, assignments] : commands.commands) words.emplace(subtype, C3Command(assignments));
  return words;
}

C3Turns::Words turn_words(const C3Commands& commands, const C3Names& names) {
  const auto steps = [&](const char* subtype) {
    const auto found = commands.commands.find(subtype);
    return found == commands.commands.end() ? std::vector<C3Step>{} : C3Command(found->second).steps();
  };
  return {steps("stop"), steps("release"), !names.stopped.empty()};
}

std::vector<C3Values::Question> questions_of(const C3Commands& commands) {
  std::vector<C3Values::Question> questions;
  for (const auto& [name, words] : commands.values) questions.push_back({name, words});
  return questions;
}

C3Jobs::Program program_of(const DriverSettings& settings) {
  const FieldChannel& channel = settings.description.field_channel;
  return {settings.description.has_field_channel, channel.chunk_bytes, seconds(channel.ack_timeout_s),
          settings.instance};
}

}  // namespace

C3Driver::C3Driver(const DriverSettings& settings, C3Commands commands)
    : own_id_(settings.id),
      fields_(settings.description.has_field_channel),
      names_(std::move(commands.names)),
      turns_(link_, polls_, turn_words(commands, names_)),
      jobs_({names_, link_, polls_, turns_}, program_of(settings), words_of(commands)),
      messages_(names_, own_id_),
      faults_(settings.description.capabilities),
      values_(link_, questions_of(commands), {settings.commands.requests.begin(), settings.commands.requests.end()}) {}

bool C3Driver::knows(MessageType type, std::string_view subtype) const {
  if (fields_) return true;
  if (type == MessageType::command) return jobs_.has_words(subtype);
  return type == MessageType::request && values_.answers(subtype);
}

Result<Progress> C3Driver::hand_over(const Handover& message, Now now, const DriverOut& out) {
  if (!online()) return offline();
  if (message.type == MessageType::request && values_.answers(message.subtype)) {
    if (const Status asked = values_.ask(message, now, out); !asked) return asked.error();
    return Progress::queued;
  }
  if (faults_.program_stopped() && message.type == MessageType::command) return faults_.why_stopped();
  if (const Status added = jobs_.add(message, now, out); !added) return added.error();
  return Progress::queued;
}

void C3Driver::forget(Token token, Now now, const DriverOut& out) {
  values_.forget(token);
  jobs_.forget(token, now, out);
}

void C3Driver::halt(Token token, Now now, const DriverOut& out) {
  if (!jobs_.halt(token, now, out)) return out.emit(Halted{token});
  end_motion(token, now, out);
}

void C3Driver::end_motion(Token token, Now now, const DriverOut& out) {
  if (!up_ || (turns_.may_be_stopped() && !turns_.releases())) return;
  out.out.count("to_robot.stop");
  turns_.end_motion(token, now, out);
  go_on(true, now, out);
}

/// A turn may have come further; `free`: commands go on.
void C3Driver::go_on(bool free, Now now, const DriverOut& out) {
  if (!turns_.ends_motion()) jobs_.drop_halted();
  if (free) jobs_.begin_next(now, out);
}

Result<Token> C3Driver::stop(Now now, const DriverOut& out) {
  const Error why = fail(Errc::fenced, "the robot was stopped before it took this message", "trb release " + own_id_);
  const bool offered = jobs_.drop(why, out);
  if (!up_) return offline();
  out.out.count("to_robot.stop");
  const Token ticket = turns_.stop(now, out);
  if (offered) jobs_.clear_offer(now, out);
  return ticket;
}

Result<Token> C3Driver::release(Now now, const DriverOut& out) {
  if (!up_) return offline();
  out.out.count("to_robot.release");
  const Token ticket = turns_.release(now, out);
  jobs_.begin_next(now, out);
  return ticket;
}

void C3Driver::on_up(Channel channel, Now now, const DriverOut& out) {
  if (channel != Channel::command) return;
  up_ = true;
  heard_ = false;
  unknown_.clear();
  reader_.clear();
  link_.clear();
  jobs_.restart();
  messages_.restart();
  values_.restart();
  polls_.restart(now);
  // A message that the last process offered and the program did not take was reported as failed: it must not begin now.
  jobs_.clear_offer(now, out);
  poll(now, out);
}

void C3Driver::on_down(Channel channel, const std::string& reason, Now, const DriverOut& out) {
  if (channel != Channel::command || !up_) return;
  const bool before = online();
  up_ = heard_ = false;
  faults_.restart();
  turns_.drop();
  values_.drop_asked();
  link_.clear();
  jobs_.drop(fail(Errc::robot_offline, "the connection to the robot's C3 server was lost: " + reason,
                  "look at the robot's power and network"),
             out);
  if (before) out.emit(LinkDown{reason});
}

void C3Driver::on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) {
  if (channel != Channel::command || !up_) return;
  std::vector<C3Reply> replies;
  const Status read = reader_.add(bytes, replies);
  for (C3Reply& reply : replies) {
    if (!up_) return;
    if (const auto answer = link_.take(std::move(reply), now, out)) on_answer(*answer, now, out);
  }
  if (!read && up_) drop_connection("bad_packet", read.error().what, now, out);
}

void C3Driver::drop_connection(const std::string& counted, const std::string& reason, Now now, const DriverOut& out) {
  out.refuse(counted, "the connection to the robot's C3 server is closed: " + reason);
  out.robot.close(Channel::command, reason);
  on_down(Channel::command, reason, now, out);
}

void C3Driver::probe(Probe what, const std::string& variable, Now now, const DriverOut& out) {
  if (variable.empty()) return;
  link_.ask({C3Purpose::probe, variable, std::nullopt, static_cast<std::uint64_t>(what)}, now, out);
}

void C3Driver::poll(Now now, const DriverOut& out) {
  polls_.polled(now, jobs_.under_way() || turns_.open());
  if (!link_.idle()) return;
  if (turns_.open()) probe(Probe::stopped, names_.stopped, now, out);
  if (jobs_.waits_for_chunk()) probe(Probe::chunk, names_.chunk, now, out);
  if (jobs_.waits_to_be_taken()) probe(Probe::command, names_.command, now, out);
  if (fields_ || jobs_.under_way()) probe(Probe::done, names_.done, now, out);
  if (fields_) probe(Probe::out, messages_.flag(), now, out);
  probe(Probe::stop_message, names_.stop_message, now, out);
  if (polls_.take_values(now)) {
    probe(Probe::error, names_.error, now, out);
    values_.poll(now, out);
  }
  // If nothing else is read from a robot, its speed override is, to see that it is there.
  if (link_.idle()) link_.ask({C3Purpose::note, "$OV_PRO", std::nullopt, 0}, now, out);
}

void C3Driver::tick(Now now, const DriverOut& out) {
  if (!up_) return;
  if (link_.hung(now)) return drop_connection("c3_silent", "no answer for 2 s", now, out);
  jobs_.check_patience(now, out);
  if (polls_.due(now)) poll(now, out);
}

std::optional<MonotonicTime> C3Driver::next_deadline() const {
  if (!up_) return std::nullopt;
  return earlier(polls_.next(), link_.next_deadline());
}

void C3Driver::on_answer(const C3Link::Answer& answer, Now now, const DriverOut& out) {
  if (!std::exchange(heard_, true)) out.emit(LinkUp{});
  if (!answer.reply.ok) warn_unknown(answer, out);
  const std::uint64_t about = answer.ask.about;
  switch (answer.ask.purpose) {
    case C3Purpose::step:
      return jobs_.on_written(answer, now, out);
    case C3Purpose::probe:
      return on_probe(static_cast<Probe>(about), answer.reply, now, out);
    case C3Purpose::part:
      return about == C3Jobs::kMark ? jobs_.on_part(answer.reply) : messages_.on_part(answer.reply);
    case C3Purpose::clear:
      return about == C3Jobs::kMark ? jobs_.on_cleared(now, out) : messages_.on_cleared(out);
    case C3Purpose::value:
      return values_.on_value(answer, now, out);
    case C3Purpose::request:
      return values_.on_request(answer, out);
    case C3Purpose::stop:
    case C3Purpose::release:
      return on_turn(answer, now, out);
    case C3Purpose::note:
      return;
  }
}

void C3Driver::on_turn(const C3Link::Answer& answer, Now now, const DriverOut& out) {
  const bool ended = turns_.ends_motion();
  const bool free = turns_.on_written(answer, now, out);
  if (ended && !answer.reply.ok && !turns_.ends_motion()) jobs_.on_halt_refused(now, out);
  go_on(free, now, out);
}

void C3Driver::warn_unknown(const C3Link::Answer& answer, const DriverOut& out) {
  if (unknown_.insert(answer.ask.variable).second) {
    out.out.log(LogLevel::warning, "variable_refused", refused_by_robot(answer).text());
  }
}

void C3Driver::on_probe(Probe what, const C3Reply& reply, Now now, const DriverOut& out) {
  if (!reply.ok) return;
  const bool raised = krl_true(reply.value);
  switch (what) {
    case Probe::chunk:
      return jobs_.on_chunk_flag(raised, now, out);
    case Probe::command:
      return jobs_.on_command_flag(raised, now, out);
    case Probe::done:
      return jobs_.on_done_flag(raised, now, out);
    case Probe::out:
      return raised ? messages_.on_raised(link_, now, out) : void();
    case Probe::stopped:
      return go_on(turns_.on_stopped(raised, now, out), now, out);
    case Probe::stop_message:
      return on_stop_message(raised, now, out);
    case Probe::error:
      return faults_.on_text(krl_text(reply.value), now, out);
    case Probe::error_of_stop:
      faults_.report_stop(krl_text(reply.value), now, out);
      return on_program_stopped(now, out);
  }
}

void C3Driver::on_stop_message(bool raised, Now now, const DriverOut& out) {
  if (!faults_.on_stop_message(raised, names_.stop_message, out)) return;
  // Its text may be newer than the flag: it is read now.
  if (!names_.error.empty()) return probe(Probe::error_of_stop, names_.error, now, out);
  faults_.report_stop(std::nullopt, now, out);
  on_program_stopped(now, out);
}

/// The controller has stopped its program in the middle of its work. A person may start it again: a motion that was
/// reported as failed must not go on then, so the robot is ordered to stop it.
void C3Driver::on_program_stopped(Now now, const DriverOut& out) {
  const C3Jobs::Broken broken = jobs_.fail_all(faults_.why_stopped(), out);
  if (broken.moved) end_motion(0, now, out);
  if (broken.offered) jobs_.clear_offer(now, out);
}

}  // namespace trb::drivers
