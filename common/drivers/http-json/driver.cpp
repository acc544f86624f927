#include "common/drivers/http-json/driver.hpp"

#include <algorithm>
#include <utility>

#include "common/drivers/http-json/keys.hpp"

namespace trb::drivers {
namespace {

/// A stop or release whose connection is lost this often in a row counts as refused by the robot.
constexpr std::size_t kLostOften = 3;

std::map<std::string, HttpQuestion> questions_of(const HttpCommands& commands, const VendorCommands& vendor,
                                                 const Description& description) {
  std::map<std::string, HttpQuestion> out;
  for (const std::string& name : needed_values(vendor, description)) {
    if (const auto question = commands.values.find(name); question != commands.values.end()) out.insert(*question);
  }
  return out;
}

/// A path that every such robot has: that of its stop.
HttpPath probe_of(const HttpCommands& commands) {
  const auto stop = commands.commands.find("stop");
  return stop == commands.commands.end() || stop->second.empty() ? *HttpPath::read("/") : stop->second.front().path;
}

std::string text_of(const HttpCall& words) {
  return words.method + " " + words.path.text();
}

}  // namespace

HttpJsonDriver::HttpJsonDriver(const DriverSettings& settings, HttpCommands commands)
    : PolledDriver(settings,
                   HttpPoll(questions_of(commands, settings.commands, settings.description), probe_of(commands),
                            seconds(http_timing(settings.commands).poll_s)),
                   {.offline = "the robot's controller does not answer",
                    .robot = "robot",
                    .answered = "it had answered",
                    .step = "request",
                    .well = "answered well"}),
      session_(settings),
      body_(http_body(settings.commands)),
      sign_out_(std::move(commands.sign_out)),
      timeout_(seconds(http_timing(settings.commands).timeout_s)) {
  commands_ = std::move(commands.commands);
}

Result<std::vector<HttpStep>> HttpJsonDriver::fill(std::string_view subtype, BytesView data) const {
  const auto found = commands_.find(subtype);
  if (found == commands_.end()) return fail(Errc::unknown_subtype, "commands.json has no such command");
  std::vector<HttpStep> out;
  for (const HttpCall& words : found->second) {
    auto path = words.path.with(data);
    const auto body = words.body ? words.body->fill(data, http_literal(body_)) : Result<std::string>(std::string());
    if (!path || !body) {
      const Error& why = path ? body.error() : path.error();
      return fail(why.code, text_of(words) + ": " + why.what, why.hint);
    }
    out.push_back({words, std::move(*path), *body});
  }
  return out;
}

void HttpJsonDriver::pump(Now now, const DriverOut& out) {
  look_at_hold(now, out);
  while (up_) {
    const Awaits next = queue_.next(now.mono >= poll_.due(), now.mono);
    if (next == Awaits::nothing) return;
    if (next == Awaits::job) {
      begin_step(now, out);
    } else if (const auto target = poll_.next(remembered_, now)) {
      send({"GET", *target, ""}, next, now, out);
    }
  }
}

void HttpJsonDriver::begin_step(Now now, const DriverOut& out) {
  const Job& job = queue_.front();
  const HttpStep& step = job.steps[job.done];
  const auto target = step.path.fill(remembered_);
  if (target) return send({step.words.method, *target, step.body}, Awaits::job, now, out);
  on_step_over(fail(target.error().code, text_of(step.words) + ": " + target.error().what, target.error().hint), false,
               now, out);
}

void HttpJsonDriver::send(const HttpRequest& request, Awaits whose, Now now, const DriverOut& out) {
  queue_.sent(whose);
  sent_at_ = now.mono;
  out.robot.write(Channel::command, session_.encode(request));
}

void HttpJsonDriver::on_up(Channel channel, Now now, const DriverOut& out) {
  if (channel != Channel::command) return;
  up_ = true;
  lost_at_.reset();
  reader_.clear();
  if (!heard_) poll_.restart(now);
  pump(now, out);
}

void HttpJsonDriver::on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) {
  if (channel != Channel::command || !up_) return;
  const auto answers = reader_.add(bytes);
  if (!answers) {
    out.refuse("bad_packet", answers.error().text());
    if (!heard_) refuse_all(answers.error(), out);
    out.robot.close(Channel::command, answers.error().what);
    reader_.clear();  // what has come of it is no answer
    return on_down(Channel::command, answers.error().what, now, out);
  }
  for (const HttpAnswer& answer : *answers) on_answer(answer, now, out);
  pump(now, out);
}

void HttpJsonDriver::on_answer(const HttpAnswer& answer, Now now, const DriverOut& out) {
  const Awaits whose = queue_.answered();
  unanswered_ = 0;
  if (whose == Awaits::nothing) return out.refuse("bad_packet", "an answer that nobody has asked for");
  if (session_.asks_for_sign_in(answer)) {
    out.out.count("to_robot.sign_in");  // the request is still the next one of its round or its command
  } else {
    if (whose == Awaits::poll) on_poll(answer, now, out);
    if (whose == Awaits::job) on_step(answer, now, out);
    look_at_link(whose, answer, out);
  }
  if (answer.closes && up_) end_connection(now, out);
}

/// Nothing more is sent on it; the shell dials anew.
void HttpJsonDriver::end_connection(Now now, const DriverOut& out) {
  up_ = false;
  lost_at_ = now.mono;
  lost_why_ = "the robot ends each connection";
  out.robot.close(Channel::command, lost_why_);
}

/// Only polls are counted: a command may need a right of its own.
void HttpJsonDriver::look_at_link(Awaits whose, const HttpAnswer& answer, const DriverOut& out) {
  const bool refused = poll_.refuses_sign_in(answer);
  if (whose != Awaits::poll && (refused || sign_ins_refused_ > 0)) return;
  if (whose == Awaits::poll && refused) {
    if (++sign_ins_refused_ >= poll_.paths()) refuse_all(http_refusal("its poll", answer), out);
    return;
  }
  sign_ins_refused_ = 0;
  refused_why_ = {};
  if (!std::exchange(heard_, true)) out.emit(LinkUp{});
}

/// A stop that waits is sent all the same; commands would only be refused, or come late.
void HttpJsonDriver::refuse_all(const Error& reason, const DriverOut& out) {
  if (refused_why_.code != Errc::ok) return;
  refused_why_ = fail(Errc::robot_offline, reason.what, reason.hint);
  heard_ = false;
  for (const Job& job : queue_.drop_for_stop()) out.emit(Refused{job.token, offline_error()});
  out.emit(LinkDown{refused_why_.what});
}

Error HttpJsonDriver::offline_error() const {
  return refused_why_.code == Errc::ok ? PolledDriver::offline_error() : refused_why_;
}

void HttpJsonDriver::on_poll(const HttpAnswer& answer, Now now, const DriverOut& out) {
  poll_.on_answer(answer, now).report(out);
}

void HttpJsonDriver::on_step(const HttpAnswer& answer, Now now, const DriverOut& out) {
  const Job& job = queue_.front();
  const HttpCall& words = job.steps[job.done].words;
  const Status kept = answer.good() ? remember(words, answer) : Status(http_refusal(text_of(words), answer));
  on_step_over(kept ? std::nullopt : std::optional(kept.error()), false, now, out);
}

Status HttpJsonDriver::remember(const HttpCall& words, const HttpAnswer& answer) {
  if (words.remembers.empty()) return Done{};
  const auto json = parse_json(answer.body);
  const Value* at = json ? find_by_pointer(*json, words.pointer) : nullptr;
  if (at == nullptr || !(at->is_text() || at->is_integer())) {
    return fail(Errc::robot_error, text_of(words) + ": the answer has no text or whole number at " + words.pointer,
                "correct the pointer in commands.json");
  }
  remembered_[words.remembers] = at->is_text() ? at->text() : std::to_string(at->integer());
  poll_.forget(words.remembers);
  return Done{};
}

void HttpJsonDriver::on_done(const Job& job, Now now, const DriverOut& out) {
  if (job.purpose == Purpose::stop) out.emit(Stopped{job.token});
  if (job.purpose == Purpose::halt) on_halt_taken(job.token, now, out);
  if (Queue::stops(job)) return out.emit(refused_turn_over(true));
  if (job.purpose == Purpose::tidy) return;
  if (job.purpose != Purpose::command) return on_released(job, out);
  out.emit(HandedOver{job.token});
  if (job.skill) out.emit(Ended{job.token, true, {}});
}

void HttpJsonDriver::on_down(Channel channel, const std::string& reason, Now now, const DriverOut& out) {
  if (channel != Channel::command) return;
  if (up_) {
    for (const HttpAnswer& answer : reader_.end()) on_answer(answer, now, out);
  }
  up_ = false;
  if (!lost_at_) lost_at_ = now.mono;
  lost_why_ = reason;
  const Awaits whose = queue_.answered();
  if (whose == Awaits::job) on_lost_job(reason, now, out);
  if (whose != Awaits::nothing) on_unanswered(reason, now, out);
}

/// HTTP allows a connection to end before an answer: only several in a row, for as long as one answer may take, count.
void HttpJsonDriver::on_unanswered(const std::string& reason, Now now, const DriverOut& out) {
  if (unanswered_++ == 0) unanswered_since_ = now.mono;
  const bool long_enough = now.mono - unanswered_since_ >= timeout_;
  if (heard_ && unanswered_ >= kMostUnanswered && long_enough) go_offline(reason, out);
}

void HttpJsonDriver::on_lost_job(const std::string& reason, Now now, const DriverOut& out) {
  Job& job = queue_.front();
  const Error lost = fail(Errc::robot_offline,
                          "the connection was lost before the answer to " + text_of(job.steps[job.done].words) +
                              ", and nobody knows whether it was taken: " + reason,
                          "look at the robot before you send it again");
  if (job.purpose == Purpose::command || job.purpose == Purpose::tidy) return on_step_over(lost, false, now, out);
  // Stopping or releasing twice does no harm: it stays, and is sent first on the next connection.
  out.out.count(Queue::stops(job) ? "to_robot.stop_again" : "to_robot.release_again");
  if (++job.lost != kLostOften) return;
  Queue::stops(job) ? report_not_stopped(job, lost, out) : report_not_going_on(lost, out);
}

void HttpJsonDriver::go_offline(const std::string& reason, const DriverOut& out) {
  heard_ = false;
  sign_ins_refused_ = 0;
  refused_why_ = {};
  for (const Job& job : clear_queue()) {
    if (job.purpose != Purpose::command) continue;
    out.emit(Refused{job.token, fail(Errc::robot_offline, "the robot does not answer any more: " + reason,
                                     "look at its power and network, then send it again")});
  }
  out.emit(LinkDown{reason});
}

void HttpJsonDriver::leave(Now, const DriverOut& out) {
  if (!up_ || !heard_ || !sign_out_) return;
  out.robot.write(Channel::command,
                  session_.encode({sign_out_->method, *sign_out_->path.fill({}),
                                   sign_out_->body ? *sign_out_->body->fill("", http_literal(body_)) : std::string()}));
}

void HttpJsonDriver::tick(Now now, const DriverOut& out) {
  if (queue_.awaits() != Awaits::nothing && now.mono >= sent_at_ + timeout_) {
    const std::string reason = "no answer in time";
    out.robot.close(Channel::command, reason);
    on_down(Channel::command, reason, now, out);
  }
  if (heard_ && lost_at_ && now.mono >= *lost_at_ + timeout_) go_offline(lost_why_, out);
  pump(now, out);
}

std::optional<MonotonicTime> HttpJsonDriver::next_deadline() const {
  std::optional<MonotonicTime> next = next_own();
  if (queue_.awaits() != Awaits::nothing) next = sent_at_ + timeout_;
  if (heard_ && lost_at_) next = earlier(next, *lost_at_ + timeout_);
  if (up_ && queue_.awaits() == Awaits::nothing) next = earlier(next, poll_.due());
  return next;
}

}  // namespace trb::drivers
