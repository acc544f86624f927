#include "common/drivers/c3/driver.hpp"

#include <algorithm>

namespace trb::drivers {
namespace {

constexpr std::size_t kMaxJobs = 64;
constexpr std::size_t kMaxRequests = 64;
constexpr std::size_t kPresetChunk = 80;
/// How often flags are read: while something is under way, and else.
constexpr Duration kPollBusy = std::chrono::milliseconds(50);
constexpr Duration kPollIdle = std::chrono::milliseconds(100);
constexpr Duration kPollValues = std::chrono::milliseconds(200);
constexpr std::int64_t kNumbers = 1'000'000;

/// A restarted node must not take the end of an old message for that of a new one.
std::int64_t first_number(std::uint64_t instance) {
  return static_cast<std::int64_t>(instance % 2000) * kNumbers;
}

Error offline() {
  return fail(Errc::robot_offline, "the robot's C3 server is not connected",
              "look at the robot's power and network, and whether its C3 server runs on port 7000");
}

C3Names names_of(const DriverSettings& settings) {
  auto names = read_c3_names(settings.commands.values, settings.description.has_field_channel);
  return names ? std::move(*names) : C3Names{};
}

}  // namespace

C3Driver::C3Driver(const DriverSettings& settings)
    : own_id_(settings.id),
      capabilities_(settings.description.capabilities),
      names_(names_of(settings)),
      fields_(settings.description.has_field_channel),
      chunk_bytes_(settings.description.field_channel.chunk_bytes),
      patience_(seconds(settings.description.field_channel.ack_timeout_s)),
      requests_(settings.commands.requests.begin(), settings.commands.requests.end()),
      done_(names_.done, {names_.done_number, names_.result, names_.text}, 0),
      out_(names_.out, {names_.out_type, names_.out_subtype, names_.out_target, names_.out_size, names_.out_data}, 1),
      last_number_(first_number(settings.instance)) {
  if (chunk_bytes_ == 0) chunk_bytes_ = kPresetChunk;
  for (const auto& [subtype, text] : settings.commands.commands) commands_.emplace(subtype, C3Words(text));
  for (const auto& [name, text] : settings.commands.values) {
    const auto words = read_c3_question(text);
    if (words && !is_c3_name(name)) questions_.push_back({name, *words});
  }
}

bool C3Driver::knows(MessageType type, std::string_view subtype) const {
  if (fields_) return true;
  if (type == MessageType::command) return commands_.contains(subtype);
  return type == MessageType::request && requests_.contains(subtype);
}

const RobotValue* C3Driver::value(std::string_view name) const {
  const auto found = values_.find(name);
  return found == values_.end() ? nullptr : &found->second;
}

Status C3Driver::may_take(const Handover& message) const {
  if (!online()) return offline();
  if (stop_message_ && message.type == MessageType::command) {
    return fail(Errc::robot_error, "the robot's controller has stopped its program: " + stop_text_,
                "clear the message on the robot's panel and start the program");
  }
  const bool skill_waits = std::ranges::any_of(jobs_, &C3Job::tracked);
  if (skill_waits || (current_ && current_->tracked)) {
    return fail(Errc::busy, "a skill runs, and the robot's program does one thing at a time",
                "wait for its end, or stop it");
  }
  if (jobs_.size() < kMaxJobs) return Done{};
  return fail(Errc::queue_full, "64 messages wait for the robot's program already", "send slower");
}

Result<Progress> C3Driver::hand_over(const Handover& message, Now now, const DriverOut& out) {
  const auto request = requests_.find(message.subtype);
  if (message.type == MessageType::request && request != requests_.end()) {
    return ask_value(message, request->second, now, out);
  }
  if (const Status taken = may_take(message); !taken) return taken.error();
  auto job = make_job(message);
  if (!job) return job.error();
  out.out.count("to_robot." + job->subtype);
  jobs_.push_back(std::move(*job));
  begin_next(now, out);
  return Progress::queued;
}

Result<C3Job> C3Driver::make_job(const Handover& message) {
  C3Job job;
  job.token = message.token;
  job.type = message.type;
  job.subtype = message.subtype;
  job.source = message.source;
  job.tracked = !message.skill.empty();
  job.number = ++last_number_;
  job.ends = !names_.done.empty();
  job.offers = fields_;
  // What the robot's program said of an earlier command is not about this one.
  if (!fields_ && job.ends) job.steps.push_back({names_.done, "FALSE"});
  const auto words = commands_.find(message.subtype);
  if (message.type == MessageType::command && words != commands_.end()) {
    auto steps = words->second.fill(message.data);
    if (!steps) return steps.error();
    job.steps.insert(job.steps.end(), steps->begin(), steps->end());
  }
  if (!fields_) return job;
  const auto steps = c3_field_steps(names_, message, job.number, chunk_bytes_);
  job.steps.insert(job.steps.end(), steps.begin(), steps.end());
  return job;
}

Result<Progress> C3Driver::ask_value(const Handover& message, const std::string& name, Now now, const DriverOut& out) {
  if (!online()) return offline();
  const auto question = std::ranges::find(questions_, name, &Question::name);
  if (question == questions_.end()) return fail(Errc::unknown_subtype, "commands.json has no value '" + name + "'");
  if (asked_.size() >= kMaxRequests) return fail(Errc::queue_full, "64 requests wait already", "ask less often");
  if (!link_.ask({C3Purpose::request, question->words.variable, std::nullopt, message.token}, now, out)) {
    return fail(Errc::queue_full, "too much waits for the robot", "ask less often");
  }
  out.out.count("to_robot." + std::string(message.subtype));
  asked_.emplace(message.token,
                 Asked{message.token, std::string(message.subtype), std::string(message.source), question->words});
  return Progress::queued;
}

void C3Driver::begin_next(Now now, const DriverOut& out) {
  if (current_ || jobs_.empty() || turn_) return;
  current_ = std::move(jobs_.front());
  jobs_.pop_front();
  do_step(now, out);
}

void C3Driver::do_step(Now now, const DriverOut& out) {
  if (current_->next == current_->steps.size()) {
    if (!current_->offers) return on_taken(now, out);
    current_->phase = C3Job::Phase::offered;
    current_->waits_since = now.mono;
    next_poll_ = now.mono;
    return;
  }
  const C3Step& step = current_->steps[current_->next];
  link_.ask({C3Purpose::step, step.variable, step.value, static_cast<std::uint64_t>(current_->number)}, now, out);
}

bool C3Driver::runs(Token token) const {
  if (current_ && current_->token == token) return true;
  return std::ranges::find(jobs_, token, &C3Job::token) != jobs_.end();
}

void C3Driver::forget(Token token, Now now, const DriverOut& out) {
  asked_.erase(token);
  std::erase_if(jobs_, [&](const C3Job& job) { return job.token == token; });
  if (!current_ || current_->token != token) return;
  current_->forgotten = true;
  if (current_->phase != C3Job::Phase::running) withdraw(now, out);
}

/// The program is not to take it any more. If it has done so in this moment, its end is heard as a late one.
void C3Driver::withdraw(Now now, const DriverOut& out) {
  link_.drop_waiting(C3Purpose::step);
  if (fields_) link_.ask({C3Purpose::note, names_.command, "FALSE", 0}, now, out);
  current_.reset();
  begin_next(now, out);
}

void C3Driver::halt(Token token, Now now, const DriverOut& out) {
  std::erase_if(jobs_, [&](const C3Job& job) { return job.token == token; });
  if (!current_ || current_->token != token) return;
  if (current_->phase != C3Job::Phase::running) return withdraw(now, out);
  end_motion(now, out);
}

void C3Driver::end_motion(Now now, const DriverOut& out) {
  current_.reset();
  if (!up_ || told_to_stop_) return;
  out.out.count("to_robot.stop");
  begin_turn(true, true, now, out);
}

Result<Token> C3Driver::stop(Now now, const DriverOut& out) {
  const bool offered = current_ && current_->phase != C3Job::Phase::running;
  drop_all(fail(Errc::fenced, "the robot was stopped before it took this message", "trb release " + own_id_), out);
  if (!up_) return offline();
  told_to_stop_ = true;
  out.out.count("to_robot.stop");
  const Token ticket = begin_turn(true, false, now, out);
  if (offered && fields_) link_.ask({C3Purpose::note, names_.command, "FALSE", 0}, now, out);
  return ticket;
}

Result<Token> C3Driver::release(Now now, const DriverOut& out) {
  if (!up_) return offline();
  out.out.count("to_robot.release");
  return begin_turn(false, false, now, out);
}

Token C3Driver::begin_turn(bool stop, bool own, Now now, const DriverOut& out) {
  const auto words = commands_.find(stop ? "stop" : "release");
  const auto steps = words == commands_.end() ? std::vector<C3Step>{} : words->second.steps();
  turn_ = Turn{stop, own, ++last_ticket_, steps.size()};
  const C3Purpose purpose = stop ? C3Purpose::stop : C3Purpose::release;
  for (const C3Step& step : steps) link_.urge({purpose, step.variable, step.value, last_ticket_}, now, out);
  next_poll_ = now.mono;
  const Token ticket = last_ticket_;
  if (steps.empty()) confirm_turn(false, now, out);
  return ticket;
}

/// A message that is carried out has been answered: whoever waits for its end hears of the stop or the loss itself.
void C3Driver::drop_all(const Error& why, const DriverOut& out) {
  link_.drop_waiting(C3Purpose::step);
  const bool open = current_ && !current_->forgotten;
  const bool unanswered = open && (!current_->told_started || current_->type == MessageType::request);
  if (unanswered) out.emit(Refused{current_->token, why});
  for (const C3Job& job : jobs_) out.emit(Refused{job.token, why});
  current_.reset();
  jobs_.clear();
}

void C3Driver::refuse_job(const Error& why, Now now, const DriverOut& out) {
  if (!current_->forgotten) out.emit(Refused{current_->token, why});
  out.out.count("from_robot.failed");
  withdraw(now, out);
}

void C3Driver::on_up(Channel channel, Now now, const DriverOut& out) {
  if (channel != Channel::command) return;
  up_ = true;
  heard_ = false;
  unknown_.clear();
  reader_.clear();
  link_.clear();
  done_.restart();
  out_.restart();
  out_data_.clear();
  next_poll_ = next_values_ = now.mono;
  // What the last process has offered and nobody has taken is told to have failed: it must not begin now.
  if (fields_) link_.ask({C3Purpose::note, names_.command, "FALSE", 0}, now, out);
  poll(now, out);
}

void C3Driver::on_down(Channel channel, const std::string& reason, Now, const DriverOut& out) {
  if (channel != Channel::command || !up_) return;
  const bool before = online();
  up_ = heard_ = false;
  stop_message_ = false;  // whoever comes back tells again what is wrong
  error_text_.clear();
  turn_.reset();
  asked_.clear();  // their askers are told at LinkDown
  link_.clear();
  drop_all(fail(Errc::robot_offline, "the connection to the robot's C3 server was lost: " + reason,
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
  out.out.close(Channel::command, reason);
  on_down(Channel::command, reason, now, out);
}

void C3Driver::probe(Probe what, const std::string& variable, Now now, const DriverOut& out) {
  if (variable.empty()) return;
  link_.ask({C3Purpose::probe, variable, std::nullopt, static_cast<std::uint64_t>(what)}, now, out);
}

void C3Driver::poll(Now now, const DriverOut& out) {
  next_poll_ = now.mono + (current_ || turn_ ? kPollBusy : kPollIdle);
  if (!link_.idle()) return;
  if (turn_) probe(Probe::stopped, names_.stopped, now, out);
  if (current_ && current_->waits_since) {
    const bool chunk = current_->phase == C3Job::Phase::writing;
    probe(chunk ? Probe::chunk : Probe::command, chunk ? names_.chunk : names_.command, now, out);
  }
  if (fields_ || current_) probe(Probe::done, names_.done, now, out);
  if (fields_) probe(Probe::out, names_.out, now, out);
  probe(Probe::stop_message, names_.stop_message, now, out);
  if (now.mono >= next_values_) {
    next_values_ = now.mono + kPollValues;
    probe(Probe::error, names_.error, now, out);
    for (std::size_t i = 0; i < questions_.size(); ++i) {
      link_.ask({C3Purpose::value, questions_[i].words.variable, std::nullopt, i}, now, out);
    }
  }
  // A robot of which nothing is read is asked for its speed override, to hear that it is there.
  if (link_.idle()) link_.ask({C3Purpose::note, "$OV_PRO", std::nullopt, 0}, now, out);
}

void C3Driver::check_patience(Now now, const DriverOut& out) {
  if (!current_ || !current_->waits_since || now.mono - *current_->waits_since < patience_) return;
  refuse_job(fail(Errc::robot_error, "the robot's program did not take the message in time",
                  "look whether the program runs on the robot (config/robots/kuka/trb.src)"),
             now, out);
}

void C3Driver::tick(Now now, const DriverOut& out) {
  if (!up_) return;
  if (link_.hung(now)) return drop_connection("c3_silent", "no answer for 2 s", now, out);
  check_patience(now, out);
  if (now.mono >= next_poll_) poll(now, out);
}

std::optional<MonotonicTime> C3Driver::next_deadline() const {
  if (!up_) return std::nullopt;
  return earlier(next_poll_, link_.next_deadline());
}

}  // namespace trb::drivers
