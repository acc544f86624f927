#include "services/scheduler/core/run/signature.hpp"

#include <algorithm>

namespace trb::scheduler {

void Signature::tick(const std::string& node, Now now, Outbox& out) {
  if (next_ > now.mono) return;
  next_ = now.mono + kSignAgain;
  out.request(node, SignRequest{kind_, {payload_}});
}

void PendingSignatures::keep_results(const std::set<TaskIndex>& tasks) {
  std::erase_if(results_, [&](const auto& one) { return !tasks.contains(one.first); });
}

std::optional<TaskIndex> PendingSignatures::result_for(const SignedRecord& record) const {
  const auto at = std::ranges::find_if(results_, [&](const auto& one) { return one.second.is_for(record); });
  if (at == results_.end()) return std::nullopt;
  return at->first;
}

bool PendingSignatures::is_for(RunRecord kind, const SignedRecord& record) const {
  const auto at = records_.find(kind);
  return at != records_.end() && at->second.is_for(record);
}

void PendingSignatures::tick(RunRecord kind, const std::string& node, Now now, Outbox& out) {
  if (const auto at = records_.find(kind); at != records_.end()) at->second.tick(node, now, out);
}

void PendingSignatures::restart(Now now) {
  for (auto& [task, signature] : results_) signature.restart(now);
  for (auto& [kind, signature] : records_) signature.restart(now);
}

std::optional<MonotonicTime> PendingSignatures::next() const {
  std::optional<MonotonicTime> out;
  for (const auto& [task, signature] : results_) out = earlier(out, signature.next());
  for (const auto& [kind, signature] : records_) out = earlier(out, signature.next());
  return out;
}

}  // namespace trb::scheduler
