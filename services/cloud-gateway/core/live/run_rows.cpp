#include "services/cloud-gateway/core/live/run_rows.hpp"

#include <algorithm>
#include <utility>

#include "common/base/hex.hpp"

namespace trb::gateway {
namespace {

RowKey key_of(const std::string& run) {
  return {RowKind::run, {}, run};
}
RowKey detail_of(const std::string& run) {
  return {RowKind::run_detail, {}, run};
}

bool is_over(RunState state) {
  return state == RunState::finished || state == RunState::aborted || state == RunState::expired;
}

/// As the scheduler counts: a FAILED task is still to be decided on.
bool is_final(TaskState state) {
  return state == TaskState::finished || state == TaskState::skipped;
}

}  // namespace

const RunSummary* RunRows::find(const std::string& run) const {
  const Row* row = book_.find(key_of(run));
  return row == nullptr ? nullptr : &std::get<RunSummary>(row->content);
}

void RunRows::take(const RunTable& table, Now now, Outbox& out) {
  std::set<std::string> missing = runs_;
  for (const RunSummary& run : table.runs) {
    missing.erase(run.run);
    lost_.erase(run.run);
    put(run, now, out);
  }
  for (const std::string& run : missing) {
    const RunSummary* known = find(run);
    if (known == nullptr) continue;
    if (is_over(known->state)) {
      book_.confirm(key_of(run), Live::live, now);
    } else {
      lost_.insert(run);
      book_.set_live(key_of(run), Live::not_heard, now);
    }
  }
}

void RunRows::take(const RunChanged& changed, Now now, Outbox& out) {
  const RunSummary* known = find(changed.run.run);
  if (known != nullptr && changed.run.version < known->version) return out.count("dropped.late");
  put(changed.run, now, out);
}

void RunRows::put(const RunSummary& run, Now now, Outbox& out) {
  const bool is_id = run.run.size() == 32 && from_hex(run.run).ok();
  if (!is_id || (!runs_.contains(run.run) && runs_.size() == kMaxRuns)) {
    return out.count(is_id ? "refused.too_many_runs" : "dropped.no_id");
  }
  const RunSummary* known = find(run.run);
  const bool was_over = known != nullptr && is_over(known->state);
  runs_.insert(run.run);
  book_.put(key_of(run.run), run, Live::live, now);
  if (is_over(run.state)) lost_.erase(run.run);
  if (is_over(run.state) && !was_over) note_over(run.run, now);
}

void RunRows::note_over(const std::string& run, Now now) {
  over_.push_back(run);
  if (over_.size() > kMaxOver) forget(std::string(over_.front()), now);
}

/// The full view of a run is newer than its summary.
void RunRows::take(RunView view, Now now, Outbox& out) {
  const RunSummary* known = find(view.run);
  if (known == nullptr) return out.count("dropped.unexpected");
  RunSummary run = *known;
  run.state = view.state;
  run.waits_for = view.waits_for;
  run.epoch = view.epoch;
  run.over = view.over;
  run.tasks_final = static_cast<std::uint32_t>(
      std::count_if(view.tasks.begin(), view.tasks.end(), [](const TaskView& task) { return is_final(task.state); }));
  lost_.erase(run.run);
  details_.erase(std::remove(details_.begin(), details_.end(), run.run), details_.end());
  details_.push_back(run.run);
  book_.put(detail_of(run.run), std::move(view), Live::live, now);
  if (details_.size() > kMaxDetails) {
    book_.remove(detail_of(details_.front()), now);
    details_.pop_front();
  }
  put(run, now, out);
}

void RunRows::forget(const std::string& run, Now now) {
  runs_.erase(run);
  lost_.erase(run);
  over_.erase(std::remove(over_.begin(), over_.end(), run), over_.end());
  details_.erase(std::remove(details_.begin(), details_.end(), run), details_.end());
  book_.remove(key_of(run), now);
  book_.remove(detail_of(run), now);
}

void RunRows::on_silence(Now now) {
  for (const std::string& run : runs_) {
    book_.set_live(key_of(run), Live::not_heard, now);
    book_.set_live(detail_of(run), Live::not_heard, now);
  }
}

}  // namespace trb::gateway
