#include "services/scheduler/core/passing.hpp"

#include <set>

#include "services/scheduler/core/scheduler_core.hpp"

namespace trb {

namespace scheduler {

namespace {

constexpr std::size_t kMaxPacked = 512U << 10U;  // half of a message, so that headers and a large result always fit

}  // namespace

std::vector<SignedRecord> pack_results(const Run& run, const std::vector<TaskIndex>& tasks) {
  std::vector<SignedRecord> out;
  std::size_t size = 0;
  for (const TaskIndex task : std::set<TaskIndex>(tasks.begin(), tasks.end())) {
    const HeldResult* held = run.results().of(task);
    if (held == nullptr) continue;
    size += held->record.payload.bytes.size() + 256;
    if (size > kMaxPacked && !out.empty()) break;
    out.push_back(held->record);
  }
  return out;
}

Baton baton_for(const Run& run, const std::vector<TaskIndex>& tasks) {
  Baton baton;
  baton.run = run.id();
  baton.digest = run.start().digest;
  baton.epoch = run.start().first.epoch;
  baton.final_tasks.bytes = to_bitmap(run.known_final());
  std::vector<TaskIndex> before;
  for (const TaskIndex task : tasks) {
    const auto& after = run.tasks()[task].after;
    before.insert(before.end(), after.begin(), after.end());
  }
  baton.results = pack_results(run, before);
  baton.tasks = tasks;
  return baton;
}

}  // namespace scheduler

using namespace scheduler;

void SchedulerCore::send(const Run& run, const Duty& duty, Step step) {
  switch (duty.kind) {
    case DutyKind::baton:
      step.out.command(duty.to, baton_for(run, duty.tasks));
      break;
    case DutyKind::results:
      step.out.command(duty.to, Results{run.id(), pack_results(run, duty.tasks), {}});
      break;
    case DutyKind::abort:
      step.out.command(duty.to, RunAbort{run.abort_order()});
      break;
  }
}

void SchedulerCore::pass_on(Run& run, Step step) {
  for (const Duty& duty : run.duties.take_due(step.now.mono)) send(run, duty, step);
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
