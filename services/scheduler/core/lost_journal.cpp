#include "services/scheduler/core/lost_journal.hpp"

namespace trb::scheduler {
namespace {

constexpr Duration kAgain = std::chrono::seconds(1);

}  // namespace

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
  out.record(JournalLost{now.utc.ns, true});
}

}  // namespace trb::scheduler
