#include "common/drivers/rapid/driver.hpp"

#include <algorithm>

namespace trb::drivers {
namespace {

constexpr std::size_t kMaxJobs = 64;
constexpr std::size_t kMaxPending = 64;
constexpr int kStateCode = 90;
constexpr Duration kPoll = std::chrono::milliseconds(200);
/// The program's own values are read while it has nothing else to do.
constexpr Duration kPollProgram = std::chrono::milliseconds(500);
/// A request that is not refused within this time is being carried out.
constexpr Duration kRefusalTime = std::chrono::milliseconds(300);
constexpr Duration kAnswerTime = std::chrono::seconds(5);

Error offline() {
  return fail(Errc::robot_offline, "the robot's RAPID server is not connected",
              "look at the robot's power and network, and whether its two tasks run");
}

}  // namespace

RapidDriver::RapidDriver(const DriverSettings& settings, const RapidCommands& commands)
    : CommandsDriver(settings.id, settings.commands), capabilities_(settings.description.capabilities) {
  for (const auto& [subtype, requests] : commands.commands) {
    RapidCommand& words = commands_[subtype];
    for (const RapidRequest& one : requests) {
      words.requests.push_back({one.code, VendorTemplate(one.text)});
      words.items = std::max(words.items, words.requests.back().text.items());
    }
  }
  for (const auto& [name, question] : commands.values) questions_.push_back({name, question});
}

Result<std::vector<RapidDriver::Step>> RapidDriver::fill(std::string_view subtype, BytesView data) const {
  const auto words = commands_.find(subtype);
  if (words == commands_.end()) return fail(Errc::unknown_subtype, "commands.json has no such command");
  const std::size_t items = words->second.items;
  const auto json = items > 0 ? parse_json(data) : Result<Value>(Value{});
  if (json && json->is_list() && json->list().size() != items) {
    return fail(Errc::bad_value,
                "the command takes " + std::to_string(items) + " items, and the data has " +
                    std::to_string(json->list().size()),
                "give a JSON list of " + std::to_string(items) + " items");
  }
  std::vector<Step> steps;
  for (const RapidCommand::Request& request : words->second.requests) {
    auto text = request.text.fill(data, rapid_literal);
    if (!text) return text.error();
    if (text->size() > kRapidString) {
      return fail(Errc::too_large,
                  "the request has " + std::to_string(text->size()) + " characters, and a RAPID string holds 80",
                  "send less, or in several commands");
    }
    steps.push_back({request.code, std::move(*text)});
  }
  return steps;
}

Status RapidDriver::may_take() const {
  if (!online()) return offline();
  if (!motors_) {
    return fail(Errc::robot_error, "the robot's motors are off" + (error_.empty() ? "" : ": " + error_),
                "clear the fault on the robot's panel and switch its motors on");
  }
  const bool skill_waits = std::ranges::any_of(jobs_, &Job::tracked);
  if (skill_waits || (current_ && current_->tracked && !current_->halted)) {
    return fail(Errc::busy, "a skill runs, and its move blocks the robot's program", "wait for its end, or stop it");
  }
  if (jobs_.size() < kMaxJobs) return Done{};
  return fail(Errc::queue_full, "64 commands wait for the robot's program already", "send slower");
}

Result<Progress> RapidDriver::hand_over(const Handover& message, Now now, const DriverOut& out) {
  if (message.type == MessageType::request) {
    const auto request = requests_.find(message.subtype);
    if (request == requests_.end()) return fail(Errc::unknown_subtype, "commands.json has no such request");
    return request_value(message, request->second, now, out);
  }
  if (const Status taken = may_take(); !taken) return taken.error();
  auto steps = fill(message.subtype, message.data);
  if (!steps) return steps.error();
  Job job;
  job.token = message.token;
  job.subtype = message.subtype;
  job.tracked = !message.skill.empty();
  job.steps = std::move(*steps);
  job.number = ++last_number_;
  out.out.count("to_robot." + job.subtype);
  jobs_.push_back(std::move(job));
  begin_next(now, out);
  return Progress::queued;
}

Result<Progress> RapidDriver::request_value(const Handover& message, const std::string& name, Now now,
                                            const DriverOut& out) {
  if (!online()) return offline();
  const std::string subtype(message.subtype);
  const auto question = std::ranges::find(questions_, name, &Question::name);
  if (question == questions_.end()) {  // the service task reports it by itself
    const RobotValue* known = value(name);
    if (known == nullptr) return fail(Errc::timeout, "the robot has not told '" + name + "' yet", "ask again");
    out.emit(Said{MessageType::information, subtype, std::string(message.source), known->json});
    return Progress::queued;
  }
  const RapidRequest& request = question->words.request;
  if (!request.service && current_) {
    return fail(Errc::busy, "a move blocks the robot's program, which is asked for '" + name + "'",
                "ask after its end, or let commands.json ask the service task: \"service " + request.text + "\"");
  }
  if (asked_.size() >= kMaxPending) {
    return fail(Errc::queue_full, "too many requests wait for the robot", "ask less often");
  }
  RapidPort& port = request.service ? service_ : program_;
  port.request({RapidPurpose::request, request.code, request.text, message.token, {}});
  out.out.count("to_robot." + subtype);
  asked_.emplace(message.token, Asked{subtype, std::string(message.source), question->words});
  go_on(now, out);
  return Progress::queued;
}

void RapidDriver::begin_next(Now now, const DriverOut& out) {
  if (current_ || jobs_.empty() || turn_ || !program_.free()) return;
  current_ = std::move(jobs_.front());
  jobs_.pop_front();
  current_->began = now.mono;
  send_step(now, out);
}

/// A command goes before members' requests; they do not part its steps.
void RapidDriver::go_on(Now now, const DriverOut& out) {
  begin_next(now, out);
  if (!current_) program_.send_request(now, out);
  service_.send_request(now, out);
}

void RapidDriver::send_step(Now now, const DriverOut& out) {
  const Step& step = current_->steps[current_->next];
  program_.ask({RapidPurpose::step, step.code, step.text, current_->number, {}}, now, out);
}

bool RapidDriver::runs(Token token) const {
  if (current_ && current_->token == token) return true;
  return std::ranges::find(jobs_, token, &Job::token) != jobs_.end();
}

void RapidDriver::forget(Token token, Now, const DriverOut&) {
  if (asked_.erase(token) > 0) {
    program_.drop_request(token);
    service_.drop_request(token);
  }
  std::erase_if(jobs_, [&](const Job& job) { return job.token == token; });
  if (current_ && current_->token == token) current_->forgotten = true;
}

void RapidDriver::halt(Token token, Now now, const DriverOut& out) {
  if (std::erase_if(jobs_, [&](const Job& job) { return job.token == token; }) > 0) return out.emit(Halted{token});
  if (current_ && current_->token == token) {
    current_->halted = true;
    answer_by_ = now.mono + kAnswerTime;
  }
  end_motion(token, now, out);
}

/// The service task ends the motion; the program then answers the request that began it.
void RapidDriver::end_motion(Token token, Now now, const DriverOut& out) {
  if (!service_up_) return;
  if (turn_ && !turn_->stop && !turn_->own && !turn_->refused) {
    // In its place it would leave the robot in the stop, for all that is known here.
    turn_->then_halts = token;
    return;
  }
  if (may_be_stopped_) return;
  out.out.count("to_robot.stop");
  begin_turn(true, true, now, out, token);
}

/// The stop or release that ends only a motion is not confirmed any more.
void RapidDriver::give_up_halt(const std::string& why, const DriverOut& out) {
  if (turn_ && turn_->own && turn_->stop) out.emit(Halted{turn_->halts, false, why});
  if (turn_ && turn_->then_halts) out.emit(Halted{*std::exchange(turn_->then_halts, std::nullopt), false, why});
}

void RapidDriver::on_halted(Token token, const DriverOut& out) {
  if (current_ && current_->halted) current_.reset();
  out.emit(Halted{token});
}

Result<Token> RapidDriver::stop(Now now, const DriverOut& out) {
  if (current_) answer_by_ = now.mono + kAnswerTime;
  drop_all(fail(Errc::fenced, "the robot was stopped before it took this message", "trb release " + own_id_), out);
  if (!service_up_) return offline();
  may_be_stopped_ = true;
  out.out.count("to_robot.stop");
  return begin_turn(true, false, now, out);
}

Result<Token> RapidDriver::release(Now now, const DriverOut& out) {
  if (!service_up_) return offline();
  if (const auto joined = join_release()) return *joined;
  out.out.count("to_robot.release");
  return begin_turn(false, false, now, out);
}

/// Anybody may release, as often as he likes: two at most are unanswered, else the service task would have no time for
/// anything else. A further one joins the one that the task has not come to.
std::optional<Token> RapidDriver::join_release() {
  const bool waits = turn_ && !turn_->stop && !turn_->own && !turn_->refused &&
                     service_.has_before(RapidPurpose::release, turn_->ticket);
  if (waits) turn_->joined = ++last_ticket_;
  return waits ? turn_->joined : std::nullopt;
}

Token RapidDriver::begin_turn(bool stop, bool own, Now now, const DriverOut& out, Token halts) {
  give_up_halt("another stop or release took its place", out);
  const auto steps = fill(stop ? "stop" : "release", {});
  const std::size_t count = steps ? steps->size() : 0;
  const Token ticket = ++last_ticket_;
  turn_ = Turn{stop, own, ticket, count, false, halts};
  const RapidPurpose purpose = stop ? RapidPurpose::stop : RapidPurpose::release;
  for (std::size_t i = 0; i < count; ++i) {
    service_.urge({purpose, (*steps)[i].code, (*steps)[i].text, ticket, {}}, now, out);
  }
  if (count == 0) confirm_turn(false, now, out);
  return ticket;
}

/// A service that waits for the end of a running command is notified of the stop or the loss itself.
void RapidDriver::drop_all(const Error& why, const DriverOut& out) {
  if (current_ && !current_->told_started && !current_->forgotten) out.emit(Refused{current_->token, why});
  for (const Job& job : jobs_) out.emit(Refused{job.token, why});
  current_.reset();
  jobs_.clear();
}

void RapidDriver::on_up(Channel channel, Now now, const DriverOut& out) {
  const bool before = online();
  if (channel == Channel::command) {
    program_up_ = true;
    program_.clear();
  }
  if (channel == Channel::monitor) {
    service_up_ = true;
    heard_ = false;
    service_.clear();
    next_poll_ = next_values_ = now.mono;
  }
  if (program_up_ && service_up_) poll(now, out);
  // The service task may have reported its state before the program was connected.
  if (!before && online()) out.emit(LinkUp{});
}

void RapidDriver::on_down(Channel channel, const std::string& reason, Now, const DriverOut& out) {
  if (channel == Channel::field) return;
  const bool before = online();
  if (channel == Channel::command) {
    program_up_ = false;
    program_.clear();
    answer_by_.reset();
  } else {
    service_up_ = heard_ = false;
    error_.clear();  // after a reconnection every fault is reported again
    service_.clear();
    turn_.reset();
  }
  lost_by_.reset();
  asked_.clear();  // LinkDown notifies their requesters
  drop_all(fail(Errc::robot_offline, "the connection to the robot's RAPID server was lost: " + reason,
                "look at the robot's power and network"),
           out);
  if (before) out.emit(LinkDown{reason});
}

void RapidDriver::on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) {
  if (channel == Channel::command && program_up_) program_.add(bytes, now);
  if (channel == Channel::monitor && service_up_) service_.add(bytes, now);
  read_all(channel, now, out);
  go_on(now, out);
}

void RapidDriver::drop_connection(Channel channel, const std::string& counted, const std::string& reason, Now now,
                                  const DriverOut& out) {
  out.refuse(counted, "the connection to the robot's RAPID server is closed: " + reason);
  out.robot.close(channel, reason);
  on_down(channel, reason, now, out);
}

void RapidDriver::poll(Now now, const DriverOut& out) {
  next_poll_ = now.mono + kPoll;
  const bool program_free = program_up_ && !current_ && jobs_.empty() && program_.idle() && now.mono >= next_values_;
  if (program_free) next_values_ = now.mono + kPollProgram;
  const bool service_free = service_up_ && service_.idle();
  if (service_free) {
    service_.ask({RapidPurpose::state, kStateCode, std::to_string(kStateCode) + " #", 0, {}}, now, out);
  }
  for (std::size_t i = 0; i < questions_.size(); ++i) {
    const RapidRequest& request = questions_[i].words.request;
    if (!(request.service ? service_free : program_free)) continue;
    (request.service ? service_ : program_).ask({RapidPurpose::value, request.code, request.text, i, {}}, now, out);
  }
}

void RapidDriver::check_times(Now now, const DriverOut& out) {
  const auto since = service_.unanswered_since();
  if (service_up_ && since && now.mono - *since >= kServiceTime) {
    return drop_connection(Channel::monitor, "service_silent", "no answer of its service task for 2 s", now, out);
  }
  if (current_ && !current_->told_started && now.mono - current_->began >= kRefusalTime) on_started(out);
  if (lost_by_ && now.mono >= *lost_by_) {
    lost_by_.reset();
    if (current_) {
      end_job(false, "the robot's motors went off" + (error_.empty() ? "" : ": " + error_), now, out);
      answer_by_ = now.mono + kAnswerTime;
      end_motion(0, now, out);
    }
  }
  if (answer_by_ && now.mono >= *answer_by_) {
    answer_by_.reset();
    if (program_up_ && !program_.idle()) {
      drop_connection(Channel::command, "no_answer", "the program did not answer the move that was ended", now, out);
    }
  }
}

void RapidDriver::tick(Now now, const DriverOut& out) {
  read_all(Channel::command, now, out);
  read_all(Channel::monitor, now, out);
  check_times(now, out);
  if (service_up_ && now.mono >= next_poll_) poll(now, out);
  go_on(now, out);
}

std::optional<MonotonicTime> RapidDriver::next_deadline() const {
  auto next = earlier(program_.next_deadline(), service_.next_deadline());
  next = earlier(next, earlier(answer_by_, lost_by_));
  if (current_ && !current_->told_started) next = earlier(next, current_->began + kRefusalTime);
  if (service_up_) next = earlier(next, next_poll_);
  return next;
}

}  // namespace trb::drivers
