#include "common/drivers/c3/jobs.hpp"

#include <algorithm>

#include "common/drivers/c3/krl.hpp"
#include "common/drivers/command_end.hpp"

namespace trb::drivers {
namespace {

// Of each kind of message: what anybody may send takes no place of a command.
constexpr std::size_t kMaxJobs = 64;
constexpr std::size_t kMaxBytes = 1U << 20U;
constexpr Duration kInformationTime = std::chrono::seconds(10);
constexpr std::size_t kPresetChunk = 80;
constexpr std::int64_t kNumbers = 1'000'000;

/// A restarted node must not mistake the end of an old message for that of a new one.
std::int64_t first_number(std::uint64_t instance) {
  return static_cast<std::int64_t>(instance % 2000) * kNumbers;
}

Error busy() {
  return fail(Errc::busy, "a skill runs, and the robot's program does one thing at a time",
              "wait for its end, or stop it");
}

/// Reports its end, whether it was answered before or not.
void tell_end(const C3Job& job, bool well, const std::string& text, const DriverOut& out) {
  const bool request = job.type == MessageType::request;
  if (request && well && !job.forgotten) return out.emit(Said{MessageType::information, job.subtype, job.source, text});
  report_end({job.token, job.subtype, job.tracked, job.told_started && !request, job.forgotten}, well, text, out);
}

}  // namespace

C3Jobs::C3Jobs(const Parts& parts, const Program& program, Commands commands)
    : names_(parts.names),
      link_(parts.link),
      polls_(parts.polls),
      turns_(parts.turns),
      program_(program),
      commands_(std::move(commands)),
      done_(names_.done, {names_.done_number, names_.result, names_.text}, kMark),
      last_number_(first_number(program.instance)) {
  if (program_.chunk_bytes == 0) program_.chunk_bytes = kPresetChunk;
}

Status C3Jobs::may_take(const Handover& message) const {
  const bool skill_waits = std::ranges::any_of(waiting_, &C3Job::tracked);
  if (skill_waits || (current_ && current_->tracked && !current_->halted)) return busy();
  std::size_t number = 0;
  std::size_t bytes = message.data.size();
  for (const C3Job& job : waiting_) {
    if (job.type != message.type) continue;
    ++number;
    bytes += job.bytes;
  }
  if (number < kMaxJobs && bytes <= kMaxBytes) return Done{};
  return fail(Errc::queue_full, std::to_string(number) + " messages wait for the robot's program already",
              "send slower");
}

Status C3Jobs::add(const Handover& message, Now now, const DriverOut& out) {
  if (const Status taken = may_take(message); !taken) return taken.error();
  auto job = make_job(message, now);
  if (!job) return job.error();
  out.out.count("to_robot." + job->subtype);
  if (job->tracked) {
    waiting_.push_front(std::move(*job));
    make_way(now, out);
  } else {
    waiting_.push_back(std::move(*job));
  }
  begin_next(now, out);
  return Done{};
}

/// A skill's time runs: what anybody may send at any time must not use it up, chunk by chunk.
void C3Jobs::make_way(Now now, const DriverOut& out) {
  if (current_ && current_->type != MessageType::command && !may_be_taken()) refuse(busy(), now, out);
}

Result<C3Job> C3Jobs::make_job(const Handover& message, Now now) {
  C3Job job;
  job.token = message.token;
  job.type = message.type;
  job.subtype = message.subtype;
  job.source = message.source;
  job.bytes = message.data.size();
  if (message.type == MessageType::information) job.until = now.mono + kInformationTime;
  job.tracked = !message.skill.empty();
  job.number = ++last_number_;
  job.ends = !names_.done.empty();
  job.offers = program_.fields;
  // The program's text about an earlier command does not concern this one.
  if (!program_.fields && job.ends) job.steps.push_back({names_.done, "FALSE"});
  if (const Status words = add_words(message, job); !words) return words.error();
  if (!program_.fields) return job;
  const auto steps = c3_field_steps(names_, message, job.number, program_.chunk_bytes);
  job.steps.insert(job.steps.end(), steps.begin(), steps.end());
  return job;
}

Status C3Jobs::add_words(const Handover& message, C3Job& job) const {
  const auto words = commands_.find(message.subtype);
  if (message.type != MessageType::command || words == commands_.end()) return Done{};
  const auto steps = words->second.fill(message.data);
  if (!steps) return steps.error();
  job.steps.insert(job.steps.end(), steps->begin(), steps->end());
  return Done{};
}

void C3Jobs::begin_next(Now now, const DriverOut& out) {
  if (current_ || waiting_.empty() || turns_.open()) return;
  current_ = std::move(waiting_.front());
  waiting_.pop_front();
  do_step(now, out);
}

void C3Jobs::do_step(Now now, const DriverOut& out) {
  if (current_->next == current_->steps.size()) {
    if (!current_->offers) return on_taken(now, out);
    current_->phase = C3Job::Phase::offered;
    current_->waits_since = now.mono;
    return polls_.soon(now);
  }
  const C3Step& step = current_->steps[current_->next];
  link_.ask({C3Purpose::step, step.variable, step.value, static_cast<std::uint64_t>(current_->number)}, now, out);
}

bool C3Jobs::runs(Token token) const {
  if (current_ && current_->token == token) return true;
  return std::ranges::find(waiting_, token, &C3Job::token) != waiting_.end();
}

void C3Jobs::forget(Token token, Now now, const DriverOut& out) {
  std::erase_if(waiting_, [&](const C3Job& job) { return job.token == token; });
  if (!current_ || current_->token != token) return;
  current_->forgotten = true;
  if (current_->phase != C3Job::Phase::running) withdraw(now, out);
}

bool C3Jobs::halt(Token token, Now now, const DriverOut& out) {
  if (std::erase_if(waiting_, [&](const C3Job& job) { return job.token == token; }) > 0) return false;
  if (!current_ || current_->token != token) return true;
  if (!may_be_taken()) {
    withdraw(now, out);
    return false;
  }
  current_->halted = true;
  current_->waits_since.reset();
  if (current_->phase != C3Job::Phase::running) clear_offer(now, out);
  return true;
}

void C3Jobs::on_halt_refused(Now now, const DriverOut& out) {
  if (!current_ || !current_->halted) return;
  current_->halted = false;
  if (current_->phase == C3Job::Phase::running) return;
  if (!current_->ends) return withdraw(now, out);
  // Its offer was taken back, and nothing tells whether that came too late but its end.
  link_.drop_waiting(C3Purpose::step);
  current_->phase = C3Job::Phase::running;
  current_->forgotten = true;
  current_->waits_since = now.mono;
}

/// The robot may have the last write that it needs to begin.
bool C3Jobs::may_be_taken() const {
  if (current_->phase != C3Job::Phase::writing || !program_.fields) return true;
  return current_->next + 1 >= current_->steps.size();
}

/// The program must not take it any more. If it has just done so, its end counts as a late one.
void C3Jobs::withdraw(Now now, const DriverOut& out) {
  link_.drop_waiting(C3Purpose::step);
  clear_offer(now, out);
  current_.reset();
  begin_next(now, out);
}

void C3Jobs::clear_offer(Now now, const DriverOut& out) {
  if (!program_.fields) return;
  link_.drop_waiting(C3Purpose::note);  // an earlier one; nothing that waits behind it offers a message yet
  link_.ask({C3Purpose::note, names_.command, "FALSE", 0}, now, out);
}

void C3Jobs::refuse(const Error& why, Now now, const DriverOut& out) {
  if (!current_->forgotten) out.emit(Refused{current_->token, why});
  out.out.count("from_robot.failed");
  withdraw(now, out);
}

bool C3Jobs::drop(const Error& why, const DriverOut& out) {
  link_.drop_waiting(C3Purpose::step);
  const bool offered = current_ && current_->phase != C3Job::Phase::running;
  const bool open = current_ && !current_->forgotten;
  const bool unanswered = open && (!current_->told_started || current_->type == MessageType::request);
  if (unanswered) out.emit(Refused{current_->token, why});
  for (const C3Job& job : waiting_) out.emit(Refused{job.token, why});
  current_.reset();
  waiting_.clear();
  return offered;
}

C3Jobs::Broken C3Jobs::fail_all(const Error& why, const DriverOut& out) {
  const bool moved = current_ && current_->phase == C3Job::Phase::running;
  if (moved && current_->tracked) {
    if (!current_->told_started) out.emit(Started{current_->token});
    out.emit(Ended{current_->token, false, why.what});
    current_->told_started = true;
  }
  return {moved, drop(why, out)};
}

void C3Jobs::drop_late(Now now, const DriverOut& out) {
  const auto late = [&](const C3Job& job) { return job.until && now.mono >= *job.until; };
  for (auto dropped = std::erase_if(waiting_, late); dropped > 0; --dropped) out.out.count("refused.timeout");
  if (!current_ || current_->phase == C3Job::Phase::running || !late(*current_)) return;
  out.out.count("refused.timeout");
  withdraw(now, out);
}

void C3Jobs::check_patience(Now now, const DriverOut& out) {
  drop_late(now, out);
  if (!current_ || !current_->waits_since || now.mono - *current_->waits_since < program_.patience) return;
  refuse(fail(Errc::robot_error, "the robot's program did not take the message in time",
              "look whether the program runs on the robot (config/robots/kuka/trb.src)"),
         now, out);
}

void C3Jobs::on_written(const C3Link::Answer& answer, Now now, const DriverOut& out) {
  if (!current_ || static_cast<std::uint64_t>(current_->number) != answer.ask.about) return;
  if (current_->halted || current_->phase == C3Job::Phase::running) return;
  if (!answer.reply.ok) return refuse(refused_by_robot(answer), now, out);
  if (current_->steps[current_->next].awaits_clear) {
    current_->waits_since = now.mono;
    return polls_.soon(now);
  }
  ++current_->next;
  do_step(now, out);
}

void C3Jobs::on_chunk_flag(bool raised, Now now, const DriverOut& out) {
  if (raised || !waits_for_chunk()) return;
  current_->waits_since.reset();
  ++current_->next;
  do_step(now, out);
}

void C3Jobs::on_command_flag(bool raised, Now now, const DriverOut& out) {
  const bool offered = current_ && current_->phase == C3Job::Phase::offered;
  if (!raised && offered && !current_->halted) on_taken(now, out);
}

void C3Jobs::on_done_flag(bool raised, Now now, const DriverOut& out) {
  if (raised) return done_.on_raised(link_, now, out);
  on_started(out);
}

void C3Jobs::on_taken(Now now, const DriverOut& out) {
  current_->phase = C3Job::Phase::running;
  current_->waits_since.reset();
  if (current_->ends) return;  // it may have been refused: the done flag is read first
  if (!current_->forgotten) out.emit(HandedOver{current_->token});
  current_.reset();
  begin_next(now, out);
}

void C3Jobs::on_started(const DriverOut& out) {
  if (!current_ || current_->phase != C3Job::Phase::running || current_->told_started) return;
  current_->told_started = true;
  if (current_->type != MessageType::request && !current_->forgotten) out.emit(Started{current_->token});
}

void C3Jobs::on_cleared(Now now, const DriverOut& out) {
  const std::vector<std::string> parts = done_.on_cleared();
  const bool ours = current_ && current_->phase != C3Job::Phase::writing &&
                    (!program_.fields || krl_whole(parts[0]) == current_->number);
  const std::string text = krl_text(parts[2]);
  if (!ours) {
    out.out.count("refused.late_done");
    return out.out.log(LogLevel::info, "late_report", "message " + parts[0] + ": " + text.substr(0, 200));
  }
  end(krl_whole(parts[1]) == 0, text, now, out);
}

void C3Jobs::end(bool well, const std::string& text, Now now, const DriverOut& out) {
  const C3Job job = std::move(*current_);
  current_.reset();
  out.out.count(well ? "from_robot.done" : "from_robot.failed");
  tell_end(job, well, text, out);
  begin_next(now, out);
}

}  // namespace trb::drivers
