#include "services/scheduler/core/delivery_sender.hpp"

#include "services/scheduler/core/passing.hpp"

namespace trb::scheduler {
namespace {

constexpr Duration kPassAgain = std::chrono::seconds(30);

void send(const Run& run, const PendingDelivery& delivery, Step step) {
  switch (delivery.kind) {
    case DeliveryKind::baton:
      return step.out.command(delivery.to, baton_for(run, delivery.tasks));
    case DeliveryKind::results:
      return step.out.command(delivery.to, pack_results(run, delivery.tasks));
    case DeliveryKind::abort:
      return step.out.command(delivery.to, RunAbort{run.orders().abort_record()});
    case DeliveryKind::decision:
      return step.out.command(delivery.to, RunDecision{run.epochs().records().back()});
    case DeliveryKind::pause:
      return step.out.command(delivery.to, RunPause{run.orders().pause_record()});
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

void send_due(Run& run, Step step) {
  pass_overdue(run, step);
  for (const PendingDelivery& delivery : run.deliveries().pending().take_due(step.now.mono)) {
    send(run, delivery, step);
  }
  for (auto& [giver, tasks] : run.work().requests().take_due_results(step.now.mono)) {
    step.out.request(giver, NeedResults{run.id(), std::move(tasks)});
  }
}

}  // namespace trb::scheduler
