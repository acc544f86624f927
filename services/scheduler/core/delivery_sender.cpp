#include "services/scheduler/core/delivery_sender.hpp"

#include <algorithm>
#include <set>

#include "services/scheduler/core/run/short_form.hpp"

namespace trb::scheduler {
namespace {

constexpr Duration kPassAgain = std::chrono::seconds(30);
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

/// Adds what is held of a task; false: it does not fit any more.
bool add_task(const Run& run, TaskIndex task, const std::vector<const HeldResult*>& proof, std::size_t& size,
              Results& out) {
  const HeldChoice* choice = run.facts().choice_on(task);
  if (proof.empty() && choice == nullptr) return true;
  for (const HeldResult* held : proof) size += size_of(held->record);
  if (choice != nullptr) size += size_of(choice->record);
  const bool fits = size <= kMaxPacked && out.results.size() + proof.size() <= kMaxTasks;
  if (!fits && !(out.results.empty() && out.choices.empty())) return false;
  for (const HeldResult* held : proof) out.results.push_back(held->record);
  add_choice(run, task, out.choices);
  return true;
}

/// As many of the tasks as fit, those with results first: an answer without any says that there is no other.
/// `proof_of`: the results to send of a task.
template <class ProofOf>
Results pack(const Run& run, const std::vector<TaskIndex>& tasks, const ProofOf& proof_of) {
  Results out{run.id(), {}, {}};
  std::size_t size = 0;
  const std::set<TaskIndex> in_order(tasks.begin(), tasks.end());
  for (const bool with_result : {true, false}) {
    for (const TaskIndex task : in_order) {
      const std::vector<const HeldResult*> proof = proof_of(task);
      if (proof.empty() == with_result) continue;
      if (!add_task(run, task, proof, size, out)) return out;
    }
  }
  return out;
}

/// What is owed of results: where a task was done twice, both, because the judge has to know.
Results pack_proofs(const Run& run, const std::vector<TaskIndex>& tasks) {
  return pack(run, tasks, [&](TaskIndex task) { return run.results().proof_of(task, run.epochs().self()); });
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

/// In short form to who understands it; what is sent again has the form that everybody does.
template <class Message>
void send(const Run& run, const PendingDelivery& delivery, Message message, Step step) {
  if (!delivery.is_again && run.deliveries().reads_short(delivery.to)) shorten(message, run.definition());
  step.out.command(delivery.to, std::move(message));
}

void send(const Run& run, const PendingDelivery& delivery, Step step) {
  switch (delivery.kind) {
    case DeliveryKind::baton:
      return send(run, delivery, baton_for(run, delivery.tasks), step);
    case DeliveryKind::results:
      return send(run, delivery, pack_proofs(run, delivery.tasks), step);
    case DeliveryKind::abort:
      return step.out.command(delivery.to, RunAbort{run.orders().abort_record()});
    case DeliveryKind::decision:
      return step.out.command(delivery.to, RunDecision{run.epochs().records().back()});
    case DeliveryKind::pause:
      return step.out.command(delivery.to, RunPause{run.orders().pause_record()});
  }
}

/// What all members hold of a run that its judge, this node, has learned of from one of them.
void ask_members(Run& run, Step step) {
  for (Recovery::Question& asks : run.recovery().take_due(run.silent_members(), run.tasks().size(), step.now.mono)) {
    if (asks.decisions) {
      step.out.request(asks.member, NeedDefinition{run.id(), run.definition().start().digest, false, true});
    } else {
      step.out.request(asks.member, NeedResults{run.id(), std::move(asks.tasks)});
    }
  }
}

/// A robot may have died for good between its result and the pass. A baton that comes twice does no harm.
void pass_overdue(Run& run, Step step) {
  for (const TaskIndex task : run.work().timers().take_due_passes(step.now.mono, step.now.mono + kPassAgain)) {
    const bool known = run.reports().is_under_way(task) || run.deliveries().has_passed(task);
    if (!known) run.deliveries().owe_batons({task});
  }
}

}  // namespace

Results pack_results(const Run& run, const std::vector<TaskIndex>& tasks) {
  return pack(run, tasks, [&](TaskIndex task) {
    const HeldResult* held = run.results().of(task);
    return held == nullptr ? std::vector<const HeldResult*>{} : std::vector<const HeldResult*>{held};
  });
}

void send_due(Run& run, Step step) {
  const bool recovers = run.is_recovering();
  if (!recovers) pass_overdue(run, step);
  for (const PendingDelivery& delivery : run.deliveries().pending().take_due(step.now.mono)) {
    if (!recovers || delivery.kind != DeliveryKind::baton) send(run, delivery, step);
  }
  if (recovers) return ask_members(run, step);
  for (auto& [giver, tasks] : run.work().awaited().take_due_results(step.now.mono)) {
    step.out.request(giver, NeedResults{run.id(), std::move(tasks)});
  }
}

}  // namespace trb::scheduler
