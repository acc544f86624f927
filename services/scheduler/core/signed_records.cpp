#include "services/scheduler/core/signed_records.hpp"

#include <algorithm>

namespace trb::scheduler {
namespace {

/// A start or a result has 512 KiB at most, a message 1 MiB.
constexpr std::size_t kPageBytes = 512U << 10U;
/// Of a record, beside its payload: kind, signer, signature.
constexpr std::size_t kRecordBytes = 256;

void append(std::vector<SignedRecord>& out, const std::vector<SignedRecord>& more) {
  out.insert(out.end(), more.begin(), more.end());
}

}  // namespace

void put_signed_records(const Run& run, JournalArchive& into) {
  into.start = run.definition().record();
  std::vector<SignedRecord> others;  // of tasks that were done twice
  for (const TaskIndex task : run.results().tasks()) {
    const std::vector<const HeldResult*> proof = run.results().proof_of(task, run.epochs().self());
    into.results.push_back(proof.front()->record);
    if (proof.size() > 1) others.push_back(proof.back()->record);
    const HeldChoice* choice = run.facts().choice_on(task);
    const bool is_new = choice != nullptr && std::ranges::find(into.choices, choice->record) == into.choices.end();
    if (is_new) into.choices.push_back(choice->record);
  }
  others.resize(std::min<std::size_t>(others.size(), kMaxTasks - into.results.size()));  // as many as a record has
  append(into.results, others);
  into.decisions = run.epochs().records();
  into.orders = run.orders().records();
  if (run.orders().has_ended()) into.end = run.orders().end_record();
}

std::vector<SignedRecord> signed_records_of(const JournalArchive& fact) {
  if (fact.start.kind.empty()) return {};
  std::vector<SignedRecord> out{fact.start};
  append(out, fact.decisions);
  append(out, fact.orders);
  append(out, fact.choices);
  append(out, fact.results);
  if (!fact.end.kind.empty()) out.push_back(fact.end);
  return out;
}

RunRecords page_of(const std::vector<SignedRecord>& all, std::uint32_t first) {
  RunRecords out;
  out.count = static_cast<std::uint32_t>(all.size());
  std::size_t bytes = 0;
  for (std::size_t i = first; i < all.size(); ++i) {
    bytes += all[i].payload.bytes.size() + kRecordBytes;
    if (bytes > kPageBytes && !out.records.empty()) break;
    out.records.push_back(all[i]);
  }
  return out;
}

}  // namespace trb::scheduler
