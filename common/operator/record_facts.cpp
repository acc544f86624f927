#include "common/operator/record_facts.hpp"

#include <algorithm>

#include "proto/body.hpp"

namespace trb::op {

bool needs_records(const RunView& view) {
  if (view.state == RunState::aborting || view.state == RunState::aborted) return true;
  return std::ranges::any_of(view.tasks, [](const TaskView& task) {
    return task.twice || (task.state == TaskState::finished && !task.moved_from.empty());
  });
}

std::optional<RunEnder> ender_of(const RunRecords& records) {
  std::optional<RunEnder> out;
  for (const SignedRecord& record : records.records) {
    if (record.kind != kSignedRunAbort) continue;
    const auto order = decode<AbortOrder>(record.payload.bytes);
    if (order && (!out || order->time < out->time.ns)) out = RunEnder{order->by, order->reason, {order->time}};
  }
  return out;
}

std::vector<TaskResult> doers_of(const RunRecords& records, const std::string& task) {
  std::vector<TaskResult> out;
  for (const SignedRecord& record : records.records) {
    if (record.kind != kSignedResult) continue;
    auto result = decode<TaskResult>(record.payload.bytes);
    if (result && result->key.task == task && result->outcome == TaskOutcome::finished) {
      out.push_back(std::move(*result));
    }
  }
  std::ranges::stable_sort(out, {}, &TaskResult::ended);
  return out;
}

}  // namespace trb::op
