#include "common/drivers/lines/driver.hpp"

#include <algorithm>

#include "proto/body.hpp"

namespace trb::drivers {
namespace {

const std::string kFaultWord = "word ";
constexpr std::array<Severity, 4> kSeverities = {Severity::warning, Severity::urgent, Severity::critical,
                                                 Severity::fatal};

std::string_view take_word(std::string_view& text) {
  const std::size_t end = std::min(text.find(' '), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return word;
}

/// In place of a severity: the reported fault is over.
bool says_over(std::string_view field, bool numeric) {
  return field == (numeric ? "0" : "OVER");
}

/// A severity by its name; numeric: by its number, from 1.
std::optional<Severity> severity_of(std::string_view field, bool numeric) {
  for (std::size_t i = 0; i < kSeverities.size(); ++i) {
    if (field == (numeric ? std::to_string(i + 1) : name_of(kSeverities[i]))) return kSeverities[i];
  }
  return std::nullopt;
}

Error not_connected() {
  return fail(Errc::no_field_channel, "no robot is connected to TCP_PORT", "start the robot's program that dials it");
}

}  // namespace

LinesDriver::LinesDriver(const FieldChannel& settings, std::string own_id)
    : settings_(settings),
      own_id_(std::move(own_id)),
      words_(settings_, own_id_),
      reader_(settings_),
      receiver_(words_),
      sender_(settings_, words_) {}

Result<Progress> LinesDriver::hand_over(const Handover& message, Now now, const DriverOut& out) {
  if (!up_) return not_connected();
  Bytes data = words_.unlike_orders(message.data);
  auto head = words_.head(message.type, message.subtype, message.source, data);
  if (!head) return head.error();
  if (!message.skill.empty()) {
    tracked_ = Tracked{message.token, std::string(message.subtype), std::string(message.skill)};
  }
  const Status taken =
      sender_.enqueue({message.token, std::string(message.subtype), std::move(*head), std::move(data)}, now, out);
  if (taken) return Progress::queued;
  if (tracked_ && tracked_->token == message.token) tracked_.reset();
  return taken.error();
}

void LinesDriver::forget(Token token, Now, const DriverOut&) {
  sender_.remove(token);
}

void LinesDriver::halt(Token token, Now now, const DriverOut& out) {
  if (sender_.remove(token)) return on_halted(token, out);
  if (!up_) return;
  // The robot discards its incomplete message, whoever sent it.
  sender_.drop_current(token, fail(Errc::conflict, "the robot was stopped while it took this message", "send it again"),
                       out);
  may_be_stopped_ = true;
  halting_ = Halting{token, last_ticket_ + 1};
  sender_.urgent(Urgent::stop, ++last_ticket_, now, out);
  sender_.urgent(Urgent::release, last_ticket_, now, out);
}

/// Until now the robot may have reported that it has come to its end.
void LinesDriver::on_halted(Token token, const DriverOut& out) {
  if (tracked_ && tracked_->token == token) tracked_.reset();
  out.emit(Halted{token});
}

Duration LinesDriver::silence_bound() const {
  return acknowledges() ? seconds(settings_.ack_timeout_s) : kTcpSilence;
}

Result<Token> LinesDriver::stop(Now now, const DriverOut& out) {
  tracked_.reset();
  halting_.reset();
  sender_.drop_all(fail(Errc::fenced, "the robot was stopped before it took this message", "trb release " + own_id_),
                   out);
  if (!up_) return not_connected();
  may_be_stopped_ = true;
  sender_.urgent(Urgent::stop, ++last_ticket_, now, out);
  return last_ticket_;
}

Result<Token> LinesDriver::release(Now now, const DriverOut& out) {
  if (!up_) return not_connected();
  sender_.urgent(Urgent::release, ++last_ticket_, now, out);
  return last_ticket_;
}

void LinesDriver::on_up(Channel channel, Now, const DriverOut& out) {
  if (channel != Channel::field) return;
  up_ = true;
  reader_.clear();
  receiver_.restart();
  sender_.restart();
  out.emit(LinkUp{});
}

void LinesDriver::on_down(Channel channel, const std::string& reason, Now, const DriverOut& out) {
  if (channel != Channel::field || !up_) return;
  up_ = false;
  tracked_.reset();
  halting_.reset();
  const bool silent = reason == "ack_timeout";
  sender_.drop_all(fail(silent ? Errc::timeout : Errc::robot_offline,
                        silent ? "the robot did not acknowledge a field in time (ack_timeout)"
                               : "the robot left before it had taken this message: " + reason,
                        "look at the robot's program"),
                   out);
  sender_.restart();
  out.emit(LinkDown{reason});
}

void LinesDriver::on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) {
  if (channel != Channel::field || !up_) return;
  // With `delay`, bytes that have waited long enough are a field of their own, separate from what arrives now.
  read_fields(now, out);
  if (!up_) return;
  reader_.add(bytes, now.mono);
  read_fields(now, out);
}

void LinesDriver::read_fields(Now now, const DriverOut& out) {
  while (up_) {
    const auto field = reader_.next(now.mono);
    if (!field) break;
    take_field(*field, now, out);
  }
  if (up_ && reader_.overflowed()) drop_connection("field_too_long", now, out);
}

void LinesDriver::take_field(std::string_view field, Now now, const DriverOut& out) {
  if (receiver_.between_messages()) {
    if (field == words_.ok()) return sender_.on_ok(now, out);
    if (const auto urgent = words_.urgent_done(field)) return take_confirmation(*urgent, now, out);
  }
  auto message = receiver_.take(field, settings_.framing == Framing::delay);
  if (!message) return drop_connection(message.error().what, now, out);
  if (*message) take_message(std::move(**message), out);
}

void LinesDriver::take_confirmation(Urgent urgent, Now now, const DriverOut& out) {
  const auto confirmed = sender_.on_urgent_done(urgent, now, out);
  if (urgent == Urgent::stop && halting_ && confirmed && *confirmed >= halting_->ticket) {
    on_halted(std::exchange(halting_, std::nullopt)->token, out);
  }
  if (urgent == Urgent::release && !sender_.urgent_pending()) may_be_stopped_ = false;
}

void LinesDriver::take_message(FieldMessage message, const DriverOut& out) {
  if (!message.refused.empty()) {
    return out.refuse(message.refused, "the robot said " + message.subtype + " to " + message.target);
  }
  out.out.count("from_robot." + message.subtype);
  const bool report = message.type == MessageType::information && message.target == own_id_;
  if (report && (message.subtype == "done" || message.subtype == "failed")) return take_report(message, out);
  if (report && message.subtype == "fault") return take_fault(message, out);
  if (is_reserved(message.subtype)) {
    return out.refuse("typed_subtype", "the robot said " + message.subtype + ", a word of the middleware's own");
  }
  out.emit(Said{message.type, std::move(message.subtype), std::move(message.target), std::move(message.data)});
}

void LinesDriver::take_report(const FieldMessage& message, const DriverOut& out) {
  std::string_view rest = message.data;
  const std::string_view field = take_word(rest);
  const std::string word = words_.numeric() ? words_.subtype_of(field).value_or("") : std::string(field);
  // A report that arrives before the robot has the whole command is about an earlier one.
  const bool ours =
      tracked_ && !sender_.holds(tracked_->token) && (word == tracked_->subtype || word == tracked_->skill);
  if (!ours) {
    out.out.count("refused.late_" + message.subtype);
    out.out.log(LogLevel::info, "late_report", message.subtype + " " + message.data.substr(0, 200));
    return;
  }
  const bool well = message.subtype == "done";
  const std::string number = words_.numeric() && !well ? "reason " : "";
  out.emit(Ended{tracked_->token, well, number + std::string(rest)});
  tracked_.reset();
}

void LinesDriver::take_fault(const FieldMessage& message, const DriverOut& out) {
  std::string_view rest = message.data;
  const std::string_view field = take_word(rest);
  const auto capability = words_.numeric() ? words_.subtype_of(field) : std::optional<std::string>(field);
  const std::string_view how = take_word(rest);
  const std::string cause = capability ? kFaultWord + *capability : std::string();
  if (capability && !capability->empty() && says_over(how, words_.numeric())) return out.emit(FaultOver{cause});
  const auto severity = severity_of(how, words_.numeric());
  if (!capability || capability->empty() || !severity) {
    return out.refuse("bad_fault", "the robot's fault is not CAPABILITY SEVERITY TEXT: " + message.data.substr(0, 200));
  }
  // Reported once; for a robot that never reports the end, a person ends it.
  out.emit(FaultSaid{*capability, *severity, std::string(rest), cause, false});
}

void LinesDriver::drop_connection(const std::string& reason, Now now, const DriverOut& out) {
  out.refuse(reason.substr(0, reason.find(':')), "the field channel is closed: " + reason);
  out.robot.close(Channel::field, reason);
  on_down(Channel::field, reason, now, out);
}

void LinesDriver::tick(Now now, const DriverOut& out) {
  if (!up_) return;
  read_fields(now, out);
  if (up_ && !sender_.tick(now, out)) drop_connection("ack_timeout", now, out);
}

std::optional<MonotonicTime> LinesDriver::next_deadline() const {
  if (!up_) return std::nullopt;
  return earlier(reader_.next_deadline(), sender_.next_deadline());
}

}  // namespace trb::drivers
