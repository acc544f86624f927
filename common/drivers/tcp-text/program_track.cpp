#include "common/drivers/tcp-text/program_track.hpp"

#include <algorithm>

namespace trb::drivers {
namespace {

constexpr std::size_t kMaxWaiting = 64;
/// Texts and key messages come from different parts of the controller: their order is not guaranteed.
constexpr Duration kGrace = std::chrono::milliseconds(200);

}  // namespace

Status ProgramTrack::submit(Program program, const DriverOut& out) {
  const bool tracked_waits =
      std::any_of(waiting_.begin(), waiting_.end(), [](const Program& other) { return other.tracked; });
  if (tracked_waits || (sent_ && sent_->tracked) || (running_ && running_->program.tracked)) {
    return fail(Errc::busy, "a skill runs, and the robot would give it up for this program",
                "wait for its end, or stop it");
  }
  if (waiting_.size() >= kMaxWaiting) {
    return fail(Errc::queue_full, std::to_string(waiting_.size()) + " programs wait for the robot already",
                "send slower");
  }
  waiting_.push_back(std::move(program));
  send_next(out);
  return Done{};
}

void ProgramTrack::send_next(const DriverOut& out) {
  if (sent_ || waiting_.empty()) return;
  sent_ = std::move(waiting_.front());
  waiting_.pop_front();
  out.robot.write(Channel::command, std::move(sent_->text));
}

void ProgramTrack::on_started(std::string_view name, const DriverOut& out) {
  if (!sent_ || sent_->name != name) return;
  out.emit(Started{sent_->token});
  running_ = Running{std::move(*sent_), false, {}, {}};
  sent_.reset();
  send_next(out);
}

void ProgramTrack::on_stopped(std::string_view name, Now now, const DriverOut& out) {
  if (!running_ || running_->program.name != name) return;
  if (running_->reached_end) return end_running(true, {}, out);
  running_->cut_short_at = now.mono + kGrace;
}

void ProgramTrack::on_text(std::string_view text, const DriverOut& out) {
  if (!running_ || running_->program.end_text != text) return;
  running_->reached_end = true;
  if (running_->cut_short_at) end_running(true, {}, out);
}

void ProgramTrack::on_error(std::string_view text) {
  if (running_) running_->error = text;
}

void ProgramTrack::on_exception(std::string_view text, const std::string& shown, const DriverOut& out) {
  if (idle()) return out.out.log(LogLevel::warning, "robot_exception", shown);
  const bool about_sent = sent_ && (!running_ || text.starts_with("compile_error"));
  if (!about_sent) {
    out.emit(FaultSaid{"", Severity::warning, running_->program.name + ": " + shown});
    return end_running(false, shown, out);
  }
  out.emit(Refused{sent_->token, fail(Errc::robot_error, shown, "look at the command in commands.json and its data")});
  out.out.count("from_robot.failed");
  sent_.reset();
  send_next(out);
}

void ProgramTrack::end_running(bool well, const std::string& text, const DriverOut& out) {
  if (!running_) return;
  out.out.count(well ? "from_robot.done" : "from_robot.failed");
  if (running_->program.tracked) out.emit(Ended{running_->program.token, well, text});
  if (!well) out.out.log(LogLevel::warning, "program_failed", running_->program.name + ": " + text);
  running_.reset();
}

void ProgramTrack::on_disabled(const Error& why, const DriverOut& out) {
  if (running_) end_running(running_->reached_end, running_->reached_end ? std::string() : why.what, out);
  drop_all(why, out);
}

bool ProgramTrack::halt(Token token) {
  return std::erase_if(waiting_, [&](const Program& program) { return program.token == token; }) > 0;
}

bool ProgramTrack::drop(Token token, const DriverOut& out) {
  const bool only_waited = halt(token);
  if (running_ && running_->program.token == token) running_.reset();
  if (sent_ && sent_->token == token) {
    sent_.reset();
    send_next(out);
  }
  return only_waited;
}

bool ProgramTrack::holds(Token token) const {
  if ((sent_ && sent_->token == token) || (running_ && running_->program.token == token)) return true;
  return std::any_of(waiting_.begin(), waiting_.end(), [&](const Program& program) { return program.token == token; });
}

void ProgramTrack::drop_all(const Error& why, const DriverOut& out) {
  if (sent_) out.emit(Refused{sent_->token, why});
  for (const Program& program : waiting_) out.emit(Refused{program.token, why});
  waiting_.clear();
  sent_.reset();
  running_.reset();
}

void ProgramTrack::tick(Now now, const DriverOut& out) {
  if (!running_ || !running_->cut_short_at || now.mono < *running_->cut_short_at) return;
  const std::string why = running_->error.empty() ? "" : ": " + running_->error;
  end_running(false, "the robot's program was stopped before its end" + why, out);
}

std::optional<MonotonicTime> ProgramTrack::next_deadline() const {
  return running_ ? running_->cut_short_at : std::nullopt;
}

}  // namespace trb::drivers
