#include "services/scheduler/core/passing.hpp"

#include <algorithm>
#include <set>

#include "services/scheduler/core/scheduler_core.hpp"

namespace trb {

namespace scheduler {

namespace {

constexpr Duration kPassAgain = std::chrono::seconds(30);
constexpr std::size_t kMaxPacked = 512U << 10U;  // half of a message, so that headers and a large result always fit

std::size_t size_of(const SignedRecord& record) {
  return record.payload.bytes.size() + 256;
}

/// Adds the choice on a task, unless it is among them: one record may be on many tasks.
void add_choice(const Run& run, TaskIndex task, std::vector<SignedRecord>& choices) {
  const HeldChoice* held = run.choice_on(task);
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
    if (const HeldChoice* choice = run.choice_on(task)) size += size_of(choice->record);
    if (size > kMaxPacked && !out.results.empty()) break;
    out.results.push_back(held->record);
    add_choice(run, task, out.choices);
  }
  return out;
}

Baton baton_for(const Run& run, const std::vector<TaskIndex>& tasks) {
  Baton baton;
  baton.run = run.id();
  baton.digest = run.start().digest;
  baton.epoch = run.epoch();
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
  baton.orders = run.orders();
  return baton;
}

}  // namespace scheduler

using namespace scheduler;

void SchedulerCore::send(const Run& run, const PendingDelivery& delivery, Step step) {
  switch (delivery.kind) {
    case DeliveryKind::baton:
      step.out.command(delivery.to, baton_for(run, delivery.tasks));
      break;
    case DeliveryKind::results:
      step.out.command(delivery.to, pack_results(run, delivery.tasks));
      break;
    case DeliveryKind::abort:
      step.out.command(delivery.to, RunAbort{run.abort_order()});
      break;
    case DeliveryKind::decision:
      step.out.command(delivery.to, RunDecision{run.decision_records().back()});
      break;
    case DeliveryKind::pause:
      step.out.command(delivery.to, RunPause{run.pause_record()});
      break;
  }
}

/// A robot may have died for good between its result and the pass. A baton that comes twice does no harm.
void SchedulerCore::pass_overdue(Run& run, Step step) {
  for (auto& [task, at] : run.pass_at) {
    if (at > step.now.mono) continue;
    at = step.now.mono + kPassAgain;
    run.pass_instead(task);
  }
}

void SchedulerCore::pass_on(Run& run, Step step) {
  for (const PendingDelivery& delivery : run.deliveries.take_due(step.now.mono)) send(run, delivery, step);
}

void SchedulerCore::ask_needs(Run& run, Step step) {
  std::map<std::string, std::vector<TaskIndex>> by_giver;
  for (auto& [task, need] : run.needs) {
    if (!need.timer.due(step.now.mono)) continue;
    need.timer.sent(step.now.mono);
    by_giver[need.giver].push_back(task);
  }
  for (auto& [giver, tasks] : by_giver) step.out.request(giver, NeedResults{run.id(), std::move(tasks)});
}

}  // namespace trb
