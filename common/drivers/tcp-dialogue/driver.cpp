#include "common/drivers/tcp-dialogue/driver.hpp"

#include <algorithm>
#include <utility>

#include "common/drivers/text/number_text.hpp"

namespace trb::drivers {
namespace {

constexpr std::size_t kMostQuoted = 100;  ///< bytes of a robot's line in a reason

std::map<std::string, DialogueQuestion> questions_of(const DialogueCommands& commands, const VendorCommands& vendor,
                                                     const Description& description) {
  std::map<std::string, DialogueQuestion> out;
  for (const std::string& name : needed_values(vendor, description)) {
    if (const auto question = commands.values.find(name); question != commands.values.end()) out.insert(*question);
  }
  return out;
}

}  // namespace

DialogueDriver::DialogueDriver(const DriverSettings& settings, DialogueCommands commands)
    : PolledDriver(settings,
                   DialoguePoll(questions_of(commands, settings.commands, settings.description),
                                seconds(commands.manner.poll_s)),
                   {.offline = "the robot's controller does not answer",
                    .robot = "robot",
                    .answered = "it had answered",
                    .step = "line",
                    .well = "answered well"}),
      manner_(std::move(commands.manner)),
      timeout_(seconds(manner_.timeout_s)),
      reader_(manner_.answer_end) {
  commands_ = std::move(commands.commands);
  if (const auto stop = commands_.find("stop"); stop != commands_.end())
    stop_lines_ = static_cast<int>(stop->second.size());
  for (const auto& [subtype, lines] : commands_) {
    for (const DialogueLine& one : lines) {
      if (one.end) ends_.push_back(*one.end);
      if (one.failure) ends_.push_back(*one.failure);
    }
  }
}

Result<std::vector<DialogueStep>> DialogueDriver::fill(std::string_view subtype, BytesView data) const {
  const auto found = commands_.find(subtype);
  if (found == commands_.end()) return fail(Errc::unknown_subtype, "commands.json has no such command");
  std::vector<DialogueStep> out;
  for (const DialogueLine& one : found->second) {
    auto line = fill_dialogue_line(one, data, manner_.line_end);
    if (!line) return fail(line.error().code, one.text + ": " + line.error().what, line.error().hint);
    out.push_back({std::move(*line), one.end, one.failure});
  }
  return out;
}

Result<Progress> DialogueDriver::hand_over(const Handover& message, Now now, const DriverOut& out) {
  if (under_way_.size() >= kMostUnderWay)
    return fail(Errc::queue_full, "too many commands wait for the robot's line that ends them", "send fewer");
  return PolledDriver::hand_over(message, now, out);
}

bool DialogueDriver::runs(Token token) const {
  return queue_.runs(token) || std::ranges::find(under_way_, token, &UnderWay::token) != under_way_.end();
}

void DialogueDriver::halt(Token token, Now now, const DriverOut& out) {
  std::erase_if(under_way_, [token](const UnderWay& one) { return one.token == token; });
  PolledDriver::halt(token, now, out);
}

Result<Token> DialogueDriver::stop(Now now, const DriverOut& out) {
  under_way_.clear();
  return PolledDriver::stop(now, out);
}

void DialogueDriver::on_up(Channel channel, Now now, const DriverOut& out) {
  if (channel != Channel::command) return;
  up_ = true;
  phase_ = manner_.greeting ? DialoguePhase::greeting : DialoguePhase::begin;
  opens_ = manner_.greeting;
  sent_at_ = now.mono;
  sent_ = "the connection (\"greeting\")";
  go_on(now, out);
}

/// What follows once everything that was said is answered.
void DialogueDriver::go_on(Now now, const DriverOut& out) {
  if (!up_ || opens_) return;
  if (phase_ == DialoguePhase::greeting) phase_ = DialoguePhase::begin;
  if (phase_ == DialoguePhase::begin && begun_ < manner_.begin.size()) {
    opens_ = true;
    send(manner_.begin[begun_++], now, out);
    sent_ = "line " + std::to_string(begun_) + R"( of "begin")";  // the line may have a password
    return;
  }
  if (phase_ == DialoguePhase::begin) {
    phase_ = DialoguePhase::talk;
    poll_.restart(now);
    const bool answers_more = poll_.due() || !manner_.keep_alive.empty();
    if (manner_.greeting || begun_ > 0 || !answers_more) become_online(out);
  }
  pump(now, out);
}

void DialogueDriver::pump(Now now, const DriverOut& out) {
  look_at_hold(now, out);
  if (!takes_orders()) return;
  const auto due = poll_.due();
  const Awaits next = queue_.next(due && now.mono >= *due, now.mono);
  if (next != Awaits::nothing) {
    queue_.sent(next);
    return send(next == Awaits::poll ? poll_.line() : queue_.front().steps[queue_.front().done].line, now, out);
  }
  const auto alive = keep_alive_due();
  if (!alive || now.mono < *alive) return;
  asks_life_ = true;
  queue_.sent(Awaits::poll);
  send(manner_.keep_alive, now, out);
}

void DialogueDriver::send(const std::string& line, Now now, const DriverOut& out) {
  sent_at_ = now.mono;
  sent_ = line;
  out.robot.write(Channel::command, line + manner_.line_end);
}

/// At once on a connection on which nothing was heard yet: any answer shows that the robot is there.
std::optional<MonotonicTime> DialogueDriver::keep_alive_due() const {
  if (manner_.keep_alive.empty() || !takes_orders() || waits()) return std::nullopt;
  return heard_ ? sent_at_ + seconds(manner_.keep_alive_s) : sent_at_;
}

void DialogueDriver::on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) {
  if (channel != Channel::command || !up_) return;
  const auto lines = reader_.add(bytes);
  if (!lines) {
    out.refuse("bad_packet", lines.error().text());
    lose(lines.error().what, now, out);
    return;
  }
  // Nothing is sent between two lines of one packet: the second would count as the answer to it.
  for (const std::string& line : *lines) {
    if (!on_line(line, now, out)) return;
  }
  go_on(now, out);
}

/// False: the connection is lost.
bool DialogueDriver::on_line(const std::string& line, Now now, const DriverOut& out) {
  if (ends_command(line, out) || is_late_end(line) || manner_.ignores(line)) return true;
  if (std::exchange(opens_, false)) return on_opening(line, now, out);
  const Awaits whose = queue_.answered();
  if (whose != Awaits::nothing) {
    on_answer(whose, line, now, out);
    return true;
  }
  // Who goes on would take each answer for the one to the line before: a refused stop for a confirmed one.
  const std::string what = "the robot said '" + cut_utf8(line, kMostQuoted) + "', which nobody had asked for";
  out.refuse("bad_packet", what);
  return lose(what + R"(: if it comes by itself, name it in "ignore", or set "greeting")", now, out);
}

bool DialogueDriver::on_opening(const std::string& line, Now now, const DriverOut& out) {
  const bool greets = phase_ == DialoguePhase::greeting;
  if (greets ? !manner_.is_bad(line) : manner_.is_good(line)) return true;
  const std::string why = dialogue_refusal(sent_, line).what;
  const bool is_new = std::exchange(refused_why_, why) != why;
  if (is_new) out.emit(LinkDown{why});
  return lose(why, now, out);
}

void DialogueDriver::on_answer(Awaits whose, const std::string& line, Now now, const DriverOut& out) {
  const bool alive = std::exchange(asks_life_, false);
  if (whose == Awaits::poll && !alive) poll_.on_answer(line, manner_, now).report(out);
  if (whose == Awaits::job) on_step(line, now, out);
  become_online(out);
}

void DialogueDriver::on_step(const std::string& line, Now now, const DriverOut& out) {
  const Job& job = queue_.front();
  const DialogueStep& step = job.steps[job.done];
  const bool ended = step.end && step.end->matches(line);
  const bool failed = step.failure && step.failure->matches(line);
  if (failed || (!ended && !manner_.is_good(line)))
    return on_step_over(dialogue_refusal(step.line, line), false, now, out);
  if (step.end && !ended) under_way_.push_back({job.token, job.skill, *step.end, step.failure});
  on_step_over(std::nullopt, false, now, out);
}

void DialogueDriver::on_done(const Job& job, Now now, const DriverOut& out) {
  if (job.purpose == Purpose::stop) out.emit(Stopped{job.token, manner_.judges()});
  if (job.purpose == Purpose::halt) on_halt_taken(job.token, now, out);
  if (Queue::stops(job)) return out.emit(refused_turn_over(true));
  if (job.purpose != Purpose::command) return on_released(job, out);
  out.out.count("from_robot.done");
  out.emit(HandedOver{job.token});
  if (runs(job.token)) return out.emit(Started{job.token});
  if (job.skill) out.emit(Ended{job.token, true, {}});
}

bool DialogueDriver::ends_command(const std::string& line, const DriverOut& out) {
  for (auto one = under_way_.begin(); one != under_way_.end(); ++one) {
    const bool well = one->end.matches(line);
    if (!well && !(one->failure && one->failure->matches(line))) continue;
    if (one->skill) out.emit(Ended{one->token, well, cut_utf8(line, kMostQuoted)});
    under_way_.erase(one);
    return true;
  }
  return false;
}

/// The end of a motion that was stopped or halted: nobody waits for it, and it answers nothing but its own command.
bool DialogueDriver::is_late_end(const std::string& line) {
  if (queue_.awaits() == Awaits::job && queue_.front().steps[queue_.front().done].end) return false;
  return std::ranges::any_of(ends_, [&](const Pattern& one) { return one.matches(line); });
}

void DialogueDriver::become_online(const DriverOut& out) {
  refused_why_.clear();
  if (!std::exchange(heard_, true)) out.emit(LinkUp{});
}

/// False, for on_line().
bool DialogueDriver::lose(const std::string& reason, Now now, const DriverOut& out) {
  out.robot.close(Channel::command, reason);
  on_down(Channel::command, reason, now, out);
  return false;
}

void DialogueDriver::on_down(Channel channel, const std::string& reason, Now now, const DriverOut& out) {
  if (channel != Channel::command || !up_) return;
  const bool under_way = queue_.awaits() == Awaits::job;
  const bool was_online = std::exchange(heard_, false);
  up_ = opens_ = asks_life_ = false;
  phase_ = DialoguePhase::down;
  begun_ = 0;
  reader_.clear();
  under_way_.clear();
  poll_.restart(now);
  bool first = true;
  for (const Job& job : clear_queue()) {
    if (job.purpose == Purpose::command) out.emit(Refused{job.token, lost(job, under_way && first, reason)});
    first = false;
  }
  if (was_online) out.emit(LinkDown{reason});
}

Error DialogueDriver::lost(const Job& job, bool under_way, const std::string& reason) {
  if (!under_way && job.done == 0) {
    return fail(Errc::robot_offline, "the connection was lost before the command was sent: " + reason,
                "look at the robot's power and network, then send it again");
  }
  return fail(Errc::robot_offline,
              "the connection was lost before the answer to " + job.steps[job.done].line +
                  ", and nobody knows whether it was taken: " + reason,
              "look at the robot before you send it again");
}

Error DialogueDriver::offline_error() const {
  if (refused_why_.empty()) return PolledDriver::offline_error();
  return fail(Errc::robot_offline, refused_why_, "look at the robot, and at \"begin\" in commands.json");
}

void DialogueDriver::tick(Now now, const DriverOut& out) {
  if (up_ && waits() && now.mono >= sent_at_ + timeout_) {
    // The answer may still come, and must not count for the next line.
    lose("no answer within " + number_text(manner_.timeout_s) + " s to " + sent_.substr(0, kMostQuoted), now, out);
    return;
  }
  if (phase_ == DialoguePhase::talk) pump(now, out);
}

std::optional<MonotonicTime> DialogueDriver::next_deadline() const {
  std::optional<MonotonicTime> next = next_own();
  if (!up_) return next;
  if (waits()) return earlier(next, sent_at_ + timeout_);
  return earlier(earlier(next, poll_.due()), keep_alive_due());
}

}  // namespace trb::drivers
