// What a RAPID server answers: a move's end, the service task's state, values.
#include <algorithm>

#include "common/drivers/command_end.hpp"
#include "common/drivers/rapid/driver.hpp"
#include "common/drivers/refused_turn.hpp"
#include "common/drivers/text/fault_text.hpp"
#include "common/drivers/text/number_text.hpp"

namespace trb::drivers {
namespace {

constexpr Duration kLossTime = std::chrono::seconds(1);
constexpr std::size_t kStateNumbers = 4;
constexpr const char* kError = "error";
constexpr const char* kMotors = "motors";

std::string reason_of(const RapidAnswer& answer) {
  return answer.text.empty() ? "it answered " + std::to_string(answer.code) + " 0" : answer.text;
}

/// The text after that many words.
std::string behind(std::string_view text, std::size_t words) {
  for (; words > 0; --words) text.remove_prefix(std::min(text.find(' '), text.size() - 1) + 1);
  return std::string(text);
}

std::string json_of(const std::vector<double>& numbers) {
  std::string out;
  for (const double number : numbers) out += (out.empty() ? "" : ",") + number_text(number);
  return "[" + out + "]";
}

Result<std::vector<double>> chosen(const RapidAnswer& answer, const std::vector<std::size_t>& indices) {
  if (!answer.ok) return fail(Errc::robot_error, "the robot refuses request " + reason_of(answer));
  if (indices.empty()) return answer.numbers;
  std::vector<double> out;
  for (const std::size_t index : indices) {
    if (index >= answer.numbers.size()) {
      return fail(
          Errc::bad_value,
          "the robot answered " + std::to_string(answer.numbers.size()) + " numbers, not so many as are asked for",
          "correct the indices in \"values\" of commands.json");
    }
    out.push_back(answer.numbers[index]);
  }
  return out;
}

}  // namespace

void RapidDriver::read_all(Channel channel, Now now, const DriverOut& out) {
  RapidPort& port = channel == Channel::command ? program_ : service_;
  const bool& up = channel == Channel::command ? program_up_ : service_up_;
  while (up && channel != Channel::field) {
    auto answer = port.next(now, out);
    if (!answer) return drop_connection(channel, "bad_answer", answer.error().what, now, out);
    if (!*answer) return;
    on_answer(**answer, now, out);
  }
}

void RapidDriver::on_answer(const RapidPort::Answer& answer, Now now, const DriverOut& out) {
  switch (answer.ask.purpose) {
    case RapidPurpose::step:
      return on_step(answer, now, out);
    case RapidPurpose::state:
      return on_state(answer.answer, now, out);
    case RapidPurpose::value:
      return on_value(answer, now, out);
    case RapidPurpose::request:
      return on_request(answer, out);
    case RapidPurpose::stop:
    case RapidPurpose::release:
      return on_turn(answer, now, out);
  }
}

void RapidDriver::on_step(const RapidPort::Answer& answer, Now now, const DriverOut& out) {
  answer_by_.reset();
  if (!current_ || current_->number != answer.ask.about) {
    out.out.count("refused.late_answer");
    out.out.log(LogLevel::info, "late_report", std::to_string(answer.ask.code) + ": " + reason_of(answer.answer));
    return begin_next(now, out);
  }
  if (!answer.answer.ok) return end_job(false, reason_of(answer.answer), now, out);
  if (++current_->next < current_->steps.size()) {
    if (!current_->halted) return send_step(now, out);
    current_.reset();  // the rest of it is not begun
    return begin_next(now, out);
  }
  end_job(true, answer.answer.text, now, out);
}

void RapidDriver::on_started(const DriverOut& out) {
  current_->told_started = true;
  if (!current_->forgotten) out.emit(Started{current_->token});
}

void RapidDriver::end_job(bool well, const std::string& text, Now now, const DriverOut& out) {
  const Job job = std::move(*current_);
  current_.reset();
  lost_by_.reset();
  out.out.count(well ? "from_robot.done" : "from_robot.failed");
  report_end({job.token, job.subtype, job.tracked, job.told_started, job.forgotten}, well, text, out);
  begin_next(now, out);
}

void RapidDriver::on_turn(const RapidPort::Answer& answer, Now now, const DriverOut& out) {
  if (!turn_ || turn_->ticket != answer.ask.about) return;
  if (!answer.answer.ok) return on_turn_refused(reason_of(answer.answer), now, out);
  if (--turn_->unanswered == 0) confirm_turn(true, now, out);
}

void RapidDriver::on_turn_refused(const std::string& why, Now now, const DriverOut& out) {
  const bool halts = turn_->own && turn_->stop;
  // Of a robot that was in no stop: it goes on.
  const bool idle_release = !turn_->own && !turn_->stop && !may_be_stopped();
  std::string text = std::string("the robot refuses to ") + (turn_->stop ? "stop" : "go on") + ": " + why;
  give_up_halt(text, out);
  out.refuse("robot_error", text);
  if (halts) {
    may_stand_ = true;  // trb_service.mod refuses only after it has raised its flag
    text += kMayStand;
  }
  if (!idle_release) out.emit(refused_turn(turn_->stop, std::move(text)));
  turn_->refused = true;
  // A person's stays open: its requester is notified at the deadline. Nobody waits for the driver's own.
  if (!turn_->own && !idle_release) return;
  turn_.reset();
  begin_next(now, out);
}

void RapidDriver::confirm_turn(bool by_robot, Now now, const DriverOut& out) {
  const Turn turn = *std::exchange(turn_, std::nullopt);
  out.emit(refused_turn_over(turn.stop));
  if (turn.stop && turn.own) {
    on_halted(turn.halts, out);
    may_stand_ = true;  // a release that is lost is given again
    begin_turn(false, true, now, out);
  } else if (turn.stop) {
    out.emit(Stopped{turn.ticket, by_robot});
  } else {
    may_stand_ = false;
    if (!turn.own) {
      may_be_stopped_ = false;
      out.emit(Released{turn.joined.value_or(turn.ticket)});
    }
    if (turn.then_halts) return end_motion(*turn.then_halts, now, out);
    begin_next(now, out);
  }
}

void RapidDriver::on_state(const RapidAnswer& answer, Now now, const DriverOut& out) {
  const bool before = online();
  heard_ = true;
  if (!before && online()) out.emit(LinkUp{});
  if (!answer.ok || answer.numbers.size() < kStateNumbers) {
    return out.refuse("bad_value", "the service task's state is not \"90 1 STOPPED MOVING MOTORS ERROR TEXT\"");
  }
  for (std::size_t i = 0; i < kStateNumbers; ++i) remember(rapid_state_values()[i], {answer.numbers[i]}, now);
  out.emit(ValuesHeard{});
  const bool motors = answer.numbers[2] != 0;
  const std::string text = behind(answer.text, kStateNumbers);
  const std::string error = answer.numbers[3] == 0 ? std::string() : text.empty() ? behind(answer.text, 3) : text;
  const bool is_new = error != error_;
  const bool went_off = motors_ && !motors;
  motors_ = motors;
  error_ = error;
  if (error.empty()) out.emit(FaultOver{kError});
  if (motors) out.emit(FaultOver{kMotors});
  if (is_new && !error.empty()) out.emit(read_fault_text(error, capabilities_, kError));
  if (went_off && error.empty()) out.emit(FaultSaid{"", Severity::critical, "the robot's motors went off", kMotors});
  // A person may switch them on again: a command that has not ended by itself must not go on then.
  if (went_off && current_) lost_by_ = now.mono + kLossTime;
}

void RapidDriver::remember(const std::string& name, std::vector<double> numbers, Now now) {
  std::string json = numbers.size() == 1 ? number_text(numbers.front()) : json_of(numbers);
  values_[name] = RobotValue{std::move(numbers), std::move(json), now.mono};
}

void RapidDriver::on_value(const RapidPort::Answer& answer, Now now, const DriverOut& out) {
  const Question& question = questions_[answer.ask.about];
  auto numbers = chosen(answer.answer, question.words.indices);
  if (!numbers) return out.out.log(LogLevel::debug, "value", question.name + ": " + numbers.error().what);
  remember(question.name, std::move(*numbers), now);
  out.emit(ValuesHeard{});
}

void RapidDriver::on_request(const RapidPort::Answer& answer, const DriverOut& out) {
  const auto found = asked_.find(answer.ask.about);
  if (found == asked_.end()) return out.out.count("refused.late_answer");
  const Asked asked = std::move(found->second);
  asked_.erase(found);
  const auto numbers = chosen(answer.answer, asked.words.indices);
  if (!numbers) return out.emit(Refused{answer.ask.about, numbers.error()});
  out.out.count("from_robot." + asked.subtype);
  out.emit(Said{MessageType::information, asked.subtype, asked.source, json_of(*numbers)});
}

}  // namespace trb::drivers
