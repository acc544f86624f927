#include "services/scheduler/core/lost_journal.hpp"

#include "common/base/steady_time.hpp"

namespace trb::scheduler {
namespace {

constexpr Duration kAgain = std::chrono::seconds(1);
constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kClocksApart = 600 * kSecond;
constexpr std::int64_t kClocksAreSet = 1'577'836'800 * kSecond;  ///< 2020: earlier it shows what a PC begins with

}  // namespace

bool LostJournal::may_have_held(std::int64_t created, UtcTime now) const {
  if (!has_been_) return false;
  const bool is_known = !open_ && time_ >= kClocksAreSet && created <= now.ns + kClocksApart;
  return !is_known || created < time_ + kClocksApart;
}

void LostJournal::tick(const std::string& node, Now now, Outbox& out) {
  if (!open_ || next_ > now.mono) return;
  next_ = now.mono + kAgain;
  OutOfUse what;
  what.severity = Severity::fatal;
  what.text = "its scheduler's journal was lost: nobody knows what of its tasks was done; look at the robot";
  what.since = now.utc.ns;
  what.by = "scheduler";
  out.command(node, TakeOutOfUse{what}, 0);  // its Ack ends this
}

void LostJournal::close(Outbox& out) {
  if (!open_) return;
  open_ = false;
  keep_time(0, out);
}

void LostJournal::keep_time(std::int64_t time, Outbox& out) {
  time_ = time;
  out.record(JournalLost{time, true});
}

void LostJournal::watch_clock(Now now, Outbox& out) {
  if (!has_been_ || open_) return;
  const std::int64_t offset = now.utc.ns - now.mono.ns;
  const std::int64_t step = pace_ ? offset - pace_->offset : 0;
  const std::int64_t slack = SteadyTime::kSlack.count();
  if (!pace_ || step > slack || step < -slack) pace_ = Pace{offset, now.mono};
  pace_->offset = offset;
  if (step > slack && time_ != 0) keep_time(0, out);  // it was taken from a clock that was not set
  if (time_ == 0 && now.mono - pace_->since >= SteadyTime::kSteady) keep_time(now.utc.ns, out);
}

std::optional<MonotonicTime> LostJournal::next() const {
  if (open_) return next_;
  const bool waits = has_been_ && time_ == 0 && pace_;
  return waits ? std::optional(pace_->since + SteadyTime::kSteady) : std::nullopt;
}

}  // namespace trb::scheduler
