#include "services/scheduler/core/run/pending_work.hpp"

namespace trb::scheduler {

void PendingWork::begin_anew(TaskIndex task) {
  withheld_.drop(task);
  timers_.drop_retry(task);
}

bool PendingWork::is_empty() const {
  return !awaited_.needs_results() && !signatures_.wants_results() && inquiries_.empty();
}

bool PendingWork::may_leave(MonotonicTime now, Duration grace) {
  if (!leaves_at_) leaves_at_ = now + grace;
  return *leaves_at_ <= now;
}

void PendingWork::restart(Now now) {
  awaited_.restart();
  for (Inquiry& inquiry : inquiries_) inquiry.restart(now);
  signatures_.restart(now);
}

std::optional<MonotonicTime> PendingWork::next() const {
  std::optional<MonotonicTime> out = earlier(awaited_.next(), signatures_.next());
  for (const Inquiry& inquiry : inquiries_) out = earlier(out, inquiry.next());
  return earlier(earlier(out, timers_.next()), leaves_at_);
}

}  // namespace trb::scheduler
