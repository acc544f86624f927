// What a KUKA's variables tell: answers to what was written, flags, values, faults.
#include <algorithm>

#include "common/base/ids.hpp"
#include "common/drivers/c3/driver.hpp"
#include "common/drivers/c3/krl.hpp"
#include "common/drivers/text/fault_text.hpp"
#include "proto/body.hpp"

namespace trb::drivers {
namespace {

constexpr const char* kStop = "stop message";
constexpr const char* kError = "error";
constexpr std::size_t kMaxMessage = 16U << 20U;
/// A text that was told so shortly before the program was stopped is why.
constexpr Duration kSameFault = std::chrono::seconds(1);
constexpr std::uint64_t kDone = 0;  ///< the mark of the done flag's asks; the other one is `out`'s

std::int64_t whole_number(const std::string& text) {
  const auto value = read_krl(text, {});
  return value && !value->numbers.empty() ? static_cast<std::int64_t>(value->numbers.front()) : 0;
}

std::optional<MessageType> type_of(const std::string& word) {
  for (const MessageType type : {MessageType::command, MessageType::request, MessageType::information}) {
    if (word == name_of(type)) return type;
  }
  return std::nullopt;
}

Error refused_by_robot(const C3Link::Answer& answer) {
  const std::string what = answer.ask.variable + (answer.ask.value ? " = " + answer.ask.value->substr(0, 80) : "");
  return fail(Errc::robot_error, "the robot refuses " + what + " (C3 error " + std::to_string(answer.reply.error) + ")",
              "look whether the variable is declared on the robot, with that type and room enough");
}

}  // namespace

void C3Driver::on_answer(const C3Link::Answer& answer, Now now, const DriverOut& out) {
  if (!heard_) {
    heard_ = true;
    out.emit(LinkUp{});
  }
  if (!answer.reply.ok) warn_unknown(answer, out);
  switch (answer.ask.purpose) {
    case C3Purpose::step:
      return on_step(answer, now, out);
    case C3Purpose::probe:
      return on_probe(static_cast<Probe>(answer.ask.about), answer.reply, now, out);
    case C3Purpose::part:
      return (answer.ask.about == kDone ? done_ : out_).on_part(answer.reply);
    case C3Purpose::clear:
      return answer.ask.about == kDone ? on_done(done_.on_cleared(), now, out) : on_out(out_.on_cleared(), out);
    case C3Purpose::value:
      return on_value(answer, now, out);
    case C3Purpose::request:
      return on_request(answer, out);
    case C3Purpose::stop:
    case C3Purpose::release:
      if (!turn_ || turn_->ticket != answer.ask.about) return;
      // What the robot does not take is not confirmed: its asker is told so at the deadline.
      if (!answer.reply.ok) return out.refuse("robot_error", refused_by_robot(answer).text());
      if (--turn_->unanswered == 0 && names_.stopped.empty()) confirm_turn(false, now, out);
      return;
    case C3Purpose::note:
      return;
  }
}

void C3Driver::warn_unknown(const C3Link::Answer& answer, const DriverOut& out) {
  if (unknown_.insert(answer.ask.variable).second) {
    out.out.log(LogLevel::warning, "variable_refused", refused_by_robot(answer).text());
  }
}

void C3Driver::on_step(const C3Link::Answer& answer, Now now, const DriverOut& out) {
  if (!current_ || static_cast<std::uint64_t>(current_->number) != answer.ask.about) return;
  if (!answer.reply.ok) return refuse_job(refused_by_robot(answer), now, out);
  if (current_->steps[current_->next].awaits_clear) {
    current_->waits_since = next_poll_ = now.mono;
    return;
  }
  ++current_->next;
  do_step(now, out);
}

void C3Driver::on_probe(Probe what, const C3Reply& reply, Now now, const DriverOut& out) {
  if (!reply.ok) return;
  const bool raised = krl_true(reply.value);
  switch (what) {
    case Probe::chunk:
      if (raised || !current_ || current_->phase != C3Job::Phase::writing || !current_->waits_since) return;
      current_->waits_since.reset();
      ++current_->next;
      return do_step(now, out);
    case Probe::command:
      if (!raised && current_ && current_->phase == C3Job::Phase::offered) on_taken(now, out);
      return;
    case Probe::done:
      if (raised) return done_.on_raised(link_, now, out);
      return on_started(out);
    case Probe::out:
      if (raised) out_.on_raised(link_, now, out);
      return;
    case Probe::stopped:
      return on_stopped(raised, now, out);
    case Probe::stop_message:
      return on_stop_message(raised, now, out);
    case Probe::error:
      return on_error_text(krl_text(reply.value), now, out);
    case Probe::error_of_stop:
      break;
  }
  const std::string text = krl_text(reply.value);
  if (!text.empty()) stop_text_ = text;
  const bool told = text == error_text_ && now.mono - error_told_ < kSameFault;
  report_fault(stop_text_, kStop, !told, now, out);
  error_text_ = text;
  on_program_stopped(now, out);
}

void C3Driver::on_taken(Now now, const DriverOut& out) {
  current_->phase = C3Job::Phase::running;
  current_->waits_since.reset();
  if (current_->ends) return;  // it may have been refused: the done flag is read first
  if (!current_->forgotten) out.emit(HandedOver{current_->token});
  current_.reset();
  begin_next(now, out);
}

void C3Driver::on_started(const DriverOut& out) {
  if (!current_ || current_->phase != C3Job::Phase::running || current_->told_started) return;
  current_->told_started = true;
  if (current_->type != MessageType::request && !current_->forgotten) out.emit(Started{current_->token});
}

void C3Driver::on_done(const std::vector<std::string>& parts, Now now, const DriverOut& out) {
  const bool ours =
      current_ && current_->phase != C3Job::Phase::writing && (!fields_ || whole_number(parts[0]) == current_->number);
  const std::string text = krl_text(parts[2]);
  if (!ours) {
    out.out.count("refused.late_done");
    return out.out.log(LogLevel::info, "late_report", "message " + parts[0] + ": " + text.substr(0, 200));
  }
  end_job(whole_number(parts[1]) == 0, text, now, out);
}

void C3Driver::end_job(bool well, const std::string& text, Now now, const DriverOut& out) {
  const C3Job job = std::move(*current_);
  current_.reset();
  out.out.count(well ? "from_robot.done" : "from_robot.failed");
  if (job.forgotten) {
    out.out.log(LogLevel::info, "late_report", job.subtype + ": " + text.substr(0, 200));
  } else if (job.type == MessageType::request && well) {
    out.emit(Said{MessageType::information, job.subtype, job.source, text});
  } else if (!well && (!job.told_started || job.type == MessageType::request)) {
    out.emit(Refused{job.token, fail(Errc::robot_error, "the robot refuses it: " + text,
                                     "look at the command, its data and the robot's program")});
  } else {
    if (!job.told_started) out.emit(Started{job.token});
    if (job.tracked) out.emit(Ended{job.token, well, text});
    if (!well) out.out.log(LogLevel::warning, "command_failed", job.subtype + ": " + text.substr(0, 200));
  }
  begin_next(now, out);
}

void C3Driver::on_out(const std::vector<std::string>& parts, const DriverOut& out) {
  out_data_ += krl_text(parts[4]);
  const std::int64_t size = whole_number(parts[3]);
  if (out_data_.size() > kMaxMessage) {
    out_data_.clear();
    return out.refuse("message_too_long", "the robot said more than 16 MB");
  }
  if (static_cast<std::int64_t>(out_data_.size()) < size) return;
  const std::string subtype = krl_text(parts[1]);
  const std::string target = krl_text(parts[2]);
  const auto type = type_of(krl_text(parts[0]));
  Bytes data = std::exchange(out_data_, {});
  const bool whole = size < 0 || static_cast<std::int64_t>(data.size()) == size;
  if (!type || !is_valid_word(subtype) || !whole || (!target.empty() && !is_valid_id(target))) {
    return out.refuse("bad_message", "the robot said " + parts[0] + " " + subtype + " to " + target +
                                         ": no message, or not of the size it told");
  }
  if (is_typed(subtype)) {
    return out.refuse("typed_subtype", "the robot said " + subtype + ", a word of the middleware's own");
  }
  out.out.count("from_robot." + subtype);
  out.emit(Said{*type, subtype, target.empty() ? own_id_ : target, std::move(data)});
}

void C3Driver::on_stopped(bool stopped, Now now, const DriverOut& out) {
  if (turn_ && turn_->unanswered == 0 && turn_->stop == stopped) confirm_turn(true, now, out);
}

void C3Driver::confirm_turn(bool by_robot, Now now, const DriverOut& out) {
  const Turn turn = *std::exchange(turn_, std::nullopt);
  if (turn.stop && turn.own) {
    begin_turn(false, true, now, out);
  } else if (turn.stop) {
    out.emit(Stopped{turn.ticket, by_robot});
  } else {
    if (!turn.own) {
      told_to_stop_ = false;
      out.emit(Released{turn.ticket});
    }
    begin_next(now, out);
  }
}

void C3Driver::on_stop_message(bool raised, Now now, const DriverOut& out) {
  if (!raised) out.emit(FaultOver{kStop});
  if (raised == stop_message_) return;
  stop_message_ = raised;
  if (!raised) return;
  stop_text_ = names_.stop_message + " is TRUE: see the message on the robot's panel";
  // Its text may be younger than the flag: it is read now.
  if (!names_.error.empty()) return probe(Probe::error_of_stop, names_.error, now, out);
  report_fault(stop_text_, kStop, true, now, out);
  on_program_stopped(now, out);
}

/// The controller has stopped its program in the middle of whatever it did. A person may start it again: what is told
/// to have failed must not go on then, so the robot is told to stop that motion.
void C3Driver::on_program_stopped(Now now, const DriverOut& out) {
  const std::string why = "the robot's controller has stopped its program: " + stop_text_;
  const bool runs = current_ && current_->phase == C3Job::Phase::running;
  if (runs && current_->tracked) {
    if (!current_->told_started) out.emit(Started{current_->token});
    out.emit(Ended{current_->token, false, why});
    current_->told_started = true;
  }
  const bool was_taking = current_ && !runs;
  drop_all(fail(Errc::robot_error, why, "clear the message on the robot's panel and start the program"), out);
  if (runs) end_motion(now, out);
  if (was_taking && fields_) link_.ask({C3Purpose::note, names_.command, "FALSE", 0}, now, out);
}

void C3Driver::on_error_text(const std::string& text, Now now, const DriverOut& out) {
  if (text.empty()) out.emit(FaultOver{kError});
  if (text == error_text_) return;
  error_text_ = text;
  if (!text.empty()) report_fault(text, kError, true, now, out);
}

void C3Driver::report_fault(const std::string& text, const char* cause, bool is_news, Now now, const DriverOut& out) {
  if (is_news) error_told_ = now.mono;
  FaultSaid fault = read_fault_text(text, capabilities_, cause);
  fault.is_news = is_news;
  out.emit(std::move(fault));
}

void C3Driver::on_value(const C3Link::Answer& answer, Now now, const DriverOut& out) {
  if (!answer.reply.ok || answer.ask.about >= questions_.size()) return;
  const Question& question = questions_[answer.ask.about];
  auto value = read_krl(answer.reply.value, question.words.components);
  if (!value) {
    if (unknown_.insert(question.name).second) out.refuse("bad_value", question.name + ": " + value.error().text());
    return;
  }
  values_[question.name] = RobotValue{std::move(value->numbers), std::move(value->json), now.mono};
  out.emit(ValuesHeard{});
}

void C3Driver::on_request(const C3Link::Answer& answer, const DriverOut& out) {
  const auto found = asked_.find(answer.ask.about);
  if (found == asked_.end()) return out.out.count("refused.late_answer");
  const Asked asked = std::move(found->second);
  asked_.erase(found);
  if (!answer.reply.ok) return out.emit(Refused{asked.token, refused_by_robot(answer)});
  auto value = read_krl(answer.reply.value, asked.words.components);
  if (!value) return out.emit(Refused{asked.token, value.error()});
  out.out.count("from_robot." + asked.subtype);
  out.emit(Said{MessageType::information, asked.subtype, asked.source, std::move(value->json)});
}

}  // namespace trb::drivers
