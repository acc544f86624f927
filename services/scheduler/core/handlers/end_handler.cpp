#include "services/scheduler/core/handlers/end_handler.hpp"

#include "services/scheduler/core/refusal.hpp"
#include "services/scheduler/core/view.hpp"

namespace trb::scheduler {
namespace {

constexpr auto kEnd = PendingSignatures::RunRecord::end;

/// Everything is done, and nothing has to be looked at by a person.
bool is_done(const Run& run) {
  return run.facts().all_final() && !run.orders().has_new_double() && !run.orders().is_held_for_doubles();
}

}  // namespace

void EndHandler::handle(const RunOver& body, const Inbound& from, Step step) {
  const auto claimed = decode<RunEnd>(body.end.payload.bytes);
  Run* run = claimed ? runs_.find(claimed->run) : nullptr;
  if (run == nullptr || run->orders().has_ended()) return step.out.count("late.run_over");
  if (auto end = run->checks().end(body.end); !end) return refuse(from, end.error(), step);
  journal_.keep_end(*run, body.end, step);
}

void EndHandler::handle(const NeedEnd& body, const Inbound& from, Step step) {
  // This node's journal may be lost: then nobody but the members knows the run, and what they have done.
  Run* run = lookup_.find_or_defer(body.run, {}, from, step);
  if (run == nullptr) return;
  if (run->epochs().judges_here() && !run->is_recovering()) request_missing(*run, from.source);
  if (run->orders().has_ended()) return step.out.reply(from, RunOver{run->orders().end_record()});
  lookup_.tell_aborted(*run, from, step);
  const std::string state(name_of(state_of(*run, executor_, step.clock())));
  step.out.reply(from, Ack{"not_over", "run " + run->id() + " is " + state});
}

/// Who asks has done what it can of its tasks, and been told that this node has the results.
void EndHandler::request_missing(Run& run, const std::string& member) const {
  AwaitedRecords& awaited = run.work().awaited();
  for (TaskIndex task = 0; task < run.tasks().size(); ++task) {
    const bool is_missing = run.epochs().robot_of(task) == member && run.facts().current(task) == nullptr;
    if (is_missing && !awaited.has_answered(member, task)) awaited.need_result(task, member, node_);
  }
}

void EndHandler::sign_end(Run& run, Step step) const {
  PendingSignatures& signatures = run.work().signatures();
  if (!run.is_open(step.steady) || run.is_recovering() || !is_done(run)) return signatures.drop(kEnd);
  if (!signatures.wants(kEnd)) {
    const RunEnd end{run.id(), run.definition().start().digest, node_, RunState::finished, step.now.utc.ns};
    signatures.want(kEnd, {kSignedRunEnd, encode(end), step.now});
  }
  signatures.tick(kEnd, node_, step.now, step.out);
}

void EndHandler::request_end(Run& run, Step step) const {
  AwaitedRecords& awaited = run.work().awaited();
  if (!run.is_open(step.steady) || !run.is_idle() || executor_.runs(run.id())) return awaited.drop_end();
  if (awaited.end_is_due(step.now.mono)) step.out.request(run.definition().rule().judge(), NeedEnd{run.id()});
}

bool EndHandler::keep_signed(Run& run, const SignedRecord& record, Step step) {
  if (!run.work().signatures().is_for(kEnd, record)) return false;
  if (auto end = run.checks().end(record); !end) {
    log_wrong_signature(end.error(), step);
    return true;
  }
  journal_.keep_end(run, record, step);
  for (const std::string& member : run.members().ids()) {
    if (member != node_) step.out.information(member, RunOver{record});
  }
  return true;
}

}  // namespace trb::scheduler
