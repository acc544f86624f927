#include "services/scheduler/core/passing.hpp"

#include <algorithm>
#include <set>

namespace trb::scheduler {

namespace {

constexpr std::size_t kMaxPacked = 512U << 10U;  // half of a message, so that headers and a large result always fit

std::size_t size_of(const SignedRecord& record) {
  return record.payload.bytes.size() + 256;
}

/// Adds the choice on a task, unless it is among them: one record may be on many tasks.
void add_choice(const Run& run, TaskIndex task, std::vector<SignedRecord>& choices) {
  const HeldChoice* held = run.facts().choice_on(task);
  const bool is_new = held != nullptr && std::find(choices.begin(), choices.end(), held->record) == choices.end();
  if (is_new) choices.push_back(held->record);
}

}  // namespace

Results pack_results(const Run& run, const std::vector<TaskIndex>& tasks) {
  Results out{run.id(), {}, {}};
  std::size_t size = 0;
  for (const TaskIndex task : std::set<TaskIndex>(tasks.begin(), tasks.end())) {
    const HeldResult* held = run.results().of(task);
    if (held == nullptr) continue;
    size += size_of(held->record);
    if (const HeldChoice* choice = run.facts().choice_on(task)) size += size_of(choice->record);
    if (size > kMaxPacked && !out.results.empty()) break;
    out.results.push_back(held->record);
    add_choice(run, task, out.choices);
  }
  return out;
}

Baton baton_for(const Run& run, const std::vector<TaskIndex>& tasks) {
  Baton baton;
  baton.run = run.id();
  baton.digest = run.definition().start().digest;
  baton.epoch = run.epochs().current();
  baton.final_tasks.bytes = to_bitmap(run.known_final());
  std::vector<TaskIndex> before;
  for (const TaskIndex task : tasks) {
    const auto& after = run.tasks()[task].after;
    before.insert(before.end(), after.begin(), after.end());
  }
  baton.results = pack_results(run, before).results;
  baton.tasks = tasks;
  for (const TaskIndex task : tasks) add_choice(run, task, baton.choices);
  baton.skipped_tasks.bytes = to_bitmap(run.known_skipped());
  baton.orders = run.orders().records();
  return baton;
}

}  // namespace trb::scheduler
