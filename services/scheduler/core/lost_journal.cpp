#include "services/scheduler/core/lost_journal.hpp"

namespace trb::scheduler {
namespace {

constexpr Duration kAgain = std::chrono::seconds(1);
constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kClocksApart = 600 * kSecond;
constexpr std::int64_t kClocksAreSet = 1'577'836'800 * kSecond;  ///< 2020: earlier it shows what a PC begins with

}  // namespace

bool LostJournal::may_have_held(std::int64_t created) const {
  return has_been_ && (open_ || time_ < kClocksAreSet || created < time_ + kClocksApart);
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

void LostJournal::close(Now now, Outbox& out) {
  if (!open_) return;
  open_ = false;
  time_ = now.utc.ns;
  out.record(JournalLost{now.utc.ns, true});
}

}  // namespace trb::scheduler
