#include "common/drivers/c3/turns.hpp"

#include <utility>

#include "common/drivers/refused_turn.hpp"

namespace trb::drivers {

Token C3Turns::stop(Now now, const DriverOut& out) {
  may_be_stopped_ = true;
  return begin(true, false, 0, now, out);
}

Token C3Turns::release(Now now, const DriverOut& out) {
  // Anybody may release, as often as he likes: two at most are unanswered.
  if (releases() && open_->unanswered == words_.release.size() && link_.has_before(C3Purpose::release, open_->ticket)) {
    return *(open_->joined = ++last_ticket_);
  }
  return begin(false, false, 0, now, out);
}

void C3Turns::end_motion(Token token, Now now, const DriverOut& out) {
  // In a release's place it would leave the robot in the stop, for all that is known here.
  if (releases()) {
    open_->then_halts = token;
    return;
  }
  begin(true, true, token, now, out);
}

void C3Turns::give_up_halt(const std::string& why, const DriverOut& out) {
  if (halts()) out.emit(Halted{open_->halts, false, why});
  if (open_ && open_->then_halts) out.emit(Halted{*std::exchange(open_->then_halts, std::nullopt), false, why});
}

Token C3Turns::begin(bool stop, bool own, Token halts, Now now, const DriverOut& out) {
  give_up_halt("another stop or release took its place", out);
  const std::vector<C3Step>& steps = stop ? words_.stop : words_.release;
  const Token ticket = ++last_ticket_;
  open_ = Turn{stop, own, ticket, steps.size(), false, halts};
  const C3Purpose purpose = stop ? C3Purpose::stop : C3Purpose::release;
  for (const C3Step& step : steps) link_.urge({purpose, step.variable, step.value, ticket}, now, out);
  polls_.soon(now);
  if (steps.empty()) confirm(false, now, out);
  return ticket;
}

bool C3Turns::on_written(const C3Link::Answer& answer, Now now, const DriverOut& out) {
  if (!open_ || open_->ticket != answer.ask.about) return false;
  if (!answer.reply.ok) return on_refused(refused_by_robot(answer), out);
  return --open_->unanswered == 0 && !words_.told_by_robot && confirm(false, now, out);
}

bool C3Turns::on_refused(const Error& why, const DriverOut& out) {
  // All its writes are on their way: others of them may be taken.
  const bool half_taken = halts() && words_.stop.size() > 1;
  // Of a robot that was in no stop: it goes on.
  const bool idle_release = !open_->own && !open_->stop && !may_be_stopped_ && !may_stand_;
  give_up_halt(why.what, out);
  out.refuse("robot_error", why.text());
  std::string text = std::string("the robot refuses to ") + (open_->stop ? "stop" : "go on") + ": " + why.what;
  if (half_taken) {
    may_stand_ = true;
    text += kMayStand;
  }
  if (!idle_release) out.emit(refused_turn(open_->stop, std::move(text)));
  open_->refused = true;
  // A person's stays open: its requester is notified at the deadline. Nobody waits for the driver's own.
  if (!open_->own && !idle_release) return false;
  open_.reset();
  return true;
}

bool C3Turns::on_stopped(bool stopped, Now now, const DriverOut& out) {
  return open_ && open_->unanswered == 0 && open_->stop == stopped && confirm(true, now, out);
}

bool C3Turns::confirm(bool by_robot, Now now, const DriverOut& out) {
  const Turn turn = *std::exchange(open_, std::nullopt);
  out.emit(refused_turn_over(turn.stop));
  if (turn.stop && turn.own) {
    out.emit(Halted{turn.halts});
    may_stand_ = true;  // a release that is lost is given again
    begin(false, true, 0, now, out);
    return !open_;
  }
  if (turn.stop) {
    out.emit(Stopped{turn.ticket, by_robot});
    return false;
  }
  may_stand_ = false;
  if (!turn.own) {
    may_be_stopped_ = false;
    out.emit(Released{turn.joined.value_or(turn.ticket)});
  }
  if (!turn.then_halts) return true;
  begin(true, true, *turn.then_halts, now, out);
  return !open_;
}

}  // namespace trb::drivers
