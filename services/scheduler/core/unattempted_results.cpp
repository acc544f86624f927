#include "services/scheduler/core/unattempted_results.hpp"

#include <set>

#include "services/scheduler/core/late_binding.hpp"
#include "services/scheduler/core/refusal.hpp"
#include "services/scheduler/core/run/drafts.hpp"

namespace trb::scheduler {

void UnattemptedResults::request(Run& run, Step step) const {
  if (run.is_recovering()) return run.work().signatures().keep_results({});
  std::set<TaskIndex> wanted;
  const UtcTime now = step.now.utc;
  const auto want = [&](TaskIndex task, const auto& make) {
    wanted.insert(task);
    run.work().signatures().want_result(task, make, node_, step.now, step.out);
  };
  const auto release = [&](TaskIndex task) { want(task, [&] { return released_result(run, task, now); }); };
  const bool signs = !run.work().withheld().are_all();
  if (signs && run.is_open(step.steady)) {
    for (const TaskIndex task : run.open_tasks().releasable()) release(task);
  }
  if (signs && run.may_start(step.steady)) {
    for (const TaskIndex task : run.open_tasks().to_bind()) release(task);
    for (const TaskIndex task : run.open_tasks().skippable()) {
      want(task, [&] { return skipped_result(run, task, now); });
    }
    for (const TaskIndex task : unbound_too_long(run, step.clock())) {
      const OnFailure then = run.tasks()[task].on_failure;
      // Else people choose, as they are asked to, or the run ends.
      if (then != OnFailure::skip && then != OnFailure::continue_) continue;
      want(task, [&] { return unbegun_result(run, task, unbound_late_text(run, task), now); });
    }
    for (const auto& [task, why] : run.work().withheld().failing()) {
      want(task, [&, of = task, text = why] { return unbegun_result(run, of, text, now); });
    }
  }
  run.work().signatures().keep_results(wanted);
}

bool UnattemptedResults::keep_signed(Run& run, const SignedRecord& record, Step step) {
  const auto task = run.work().signatures().result_for(record);
  if (!task) return false;
  auto held = run.checks().result(record);
  if (!held) {
    if (held.error().code == Errc::bad_signature) {
      withhold_unsigned(run, step);
    } else {
      log_wrong_signature(held.error(), step);
    }
    return true;
  }
  run.work().signatures().drop_result(*task);
  journal_.keep_result(run, std::move(*held), step);
  return true;
}

}  // namespace trb::scheduler
