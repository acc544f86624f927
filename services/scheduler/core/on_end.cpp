// SchedulerCore: the word that a run has FINISHED.
#include "services/scheduler/core/scheduler_core.hpp"
#include "services/scheduler/core/view.hpp"

namespace trb {

using namespace scheduler;

void SchedulerCore::keep_end(Run& run, const SignedRecord& end, Step step) {
  const JournalEnd fact{end};
  if (auto applied = run.apply(fact); !applied) {
    return step.out.log(LogLevel::error, "end_not_applied", applied.error().text());
  }
  step.out.record(fact);
  step.out.log(LogLevel::info, "run_finished", "run " + run.id() + ", says '" + run.judge() + "'");
}

bool SchedulerCore::keep_signed_end(Run& run, const SignedRecord& record, Step step) {
  if (!run.end_signature || !run.end_signature->asks_for(record)) return false;
  if (auto end = run.check_end(record); !end) return wrong_signature(end.error(), step);
  keep_end(run, record, step);
  for (const std::string& member : run.members()) {
    if (member != settings_.node) step.out.information(member, RunOver{record});
  }
  return true;
}

void SchedulerCore::handle(const RunOver& body, const Inbound& from, Step step) {
  const auto claimed = decode<RunEnd>(body.end.payload.bytes);
  Run* run = claimed ? runs_.find(claimed->run) : nullptr;
  if (run == nullptr || run->ended()) return step.out.count("late.run_over");
  if (auto end = run->check_end(body.end); !end) return refuse(from, end.error(), step);
  keep_end(*run, body.end, step);
}

void SchedulerCore::handle(const NeedEnd& body, const Inbound& from, Step step) {
  const Run* run = run_for(body.run, from, step);
  if (run == nullptr) return;
  if (run->ended()) return step.out.reply(from, RunOver{*run->end()});
  step.out.reply(from, Ack{"not_over", "run " + run->id() + " is " +
                                           std::string(name_of(state_of(*run, executor_, step.clock())))});
}

}  // namespace trb
