// SchedulerCore: how a run becomes known: submitted here, or by a baton and its definition.
#include "common/scenario/graph.hpp"
#include "services/scheduler/core/scheduler_core.hpp"

namespace trb {

using namespace scheduler;

namespace {

/// All of them, or the error of the first bad one.
template <class Held, class Check>
Result<std::vector<Held>> check_all(const std::vector<SignedRecord>& records, const Check& check) {
  std::vector<Held> out;
  for (const SignedRecord& record : records) {
    auto held = check(record);
    if (!held) return held.error();
    out.push_back(std::move(*held));
  }
  return out;
}

Error expired_before(const std::string& run) {
  return fail(Errc::expired, "run " + run + " has expired before it came here",
              "compare the nodes' clocks (trb doctor), or give it a longer life: --expires-h");
}

Error no_place() {
  return fail(Errc::queue_full, std::to_string(RunStore::kMaxRuns) + " runs are open here",
              "abort those that nobody needs: trb run list");
}

Error no_member(const std::string& run, const std::string& node) {
  return fail(Errc::bad_value, "node '" + node + "' is no member of run " + run);
}

}  // namespace

void SchedulerCore::handle(const RunSubmit& body, const Inbound& from, Step step) {
  if (from.source != settings_.node) {
    return refuse(from, fail(Errc::not_permitted, "a run is submitted on the submitter's own node"), step);
  }
  auto run = runs_.open(body.start);
  if (!run) return refuse(from, run.error(), step);
  const std::string id = run->id();
  if (!run->is_member(settings_.node)) return refuse(from, no_member(id, settings_.node), step);
  Run* known = runs_.find(id);
  if (const auto over = known == nullptr ? archive_.over(id) : std::nullopt) return refuse_over(id, *over, from, step);
  if (known != nullptr && known->record().payload != body.start.payload) {
    return refuse(from, fail(Errc::conflict, "run " + id + " is known with another start", "draw a new run id"), step);
  }
  if (known == nullptr) {
    if (run->expired(step.steady)) return refuse(from, expired_before(id), step);
    if (runs_.full()) return refuse(from, no_place(), step);
    install(std::move(*run), body.start, true, step);
  } else if (!known->submitted_here()) {
    const JournalRun fact{known->record(), true};
    step.out.record(fact);
    if (auto applied = known->apply(fact); !applied) return refuse(from, applied.error(), step);
  }
  step.out.reply(from, RunAccepted{id});
}

Status SchedulerCore::check_baton(const Run& run, const Baton& baton, Step step) const {
  const std::string name = "run " + run.id() + ": baton: ";
  if (baton.digest != run.start().digest) return fail(Errc::conflict, name + "of another definition");
  if (baton.epoch != run.epoch()) {
    return fail(Errc::conflict,
                name + "of epoch " + std::to_string(baton.epoch) + ", this is epoch " + std::to_string(run.epoch()));
  }
  if (run.expired(step.steady)) return fail(Errc::expired, name + "the run has expired");
  if (run.ended()) return fail(Errc::expired, name + "the run has FINISHED");
  for (const TaskIndex task : baton.tasks) {
    if (task >= run.tasks().size() || !run.concerns(task)) {
      return fail(Errc::bad_value, name + "task " + std::to_string(task) + " is not for '" + settings_.node + "'");
    }
  }
  return Done{};
}

void SchedulerCore::handle(const Baton& body, const Inbound& from, Step step) {
  Run* run = run_or_defer(body.run, body.digest, from, step);
  if (run == nullptr || defer_for_decisions(*run, body.epoch, from, step)) return;
  if (auto checked = check_baton(*run, body, step); !checked) return refuse(from, checked.error(), step);
  const auto bits = from_bitmap(body.final_tasks.bytes, run->tasks().size());
  if (!bits) return refuse(from, bits.error(), step);
  const auto skipped = from_bitmap(body.skipped_tasks.bytes, run->tasks().size());
  if (!skipped) return refuse(from, skipped.error(), step);
  auto results =
      check_all<HeldResult>(body.results, [&](const SignedRecord& record) { return run->check_result(record); });
  if (!results) return refuse(from, results.error(), step);
  auto choices =
      check_all<HeldChoice>(body.choices, [&](const SignedRecord& record) { return run->check_choice(record); });
  if (!choices) return refuse(from, choices.error(), step);
  if (auto taken = take_orders(*run, body.orders, step); !taken) return refuse(from, taken.error(), step);
  for (HeldResult& held : *results) keep_result(*run, std::move(held), step);
  for (HeldChoice& held : *choices) keep_choice(*run, std::move(held), step);
  step.out.information(from.source, BatonJournaled{body.run, body.epoch, body.tasks});
  if (run->aborted()) return;
  run->hear(*bits, *skipped);
  run->note_needs(from.source);
}

void SchedulerCore::handle(const BatonJournaled& body, const Inbound& from, Step step) {
  Run* run = run_for(body.run, from, step);
  if (run == nullptr) return;
  if (body.epoch == 0 || body.epoch > run->epoch()) {
    return refuse(from, fail(Errc::conflict, "run " + body.run + ": of another epoch"), step);
  }
  // A task that has gone and come back in a later epoch has to be passed again.
  if (!run->is_of_epoch(body.tasks, body.epoch)) return step.out.count("late.baton_journaled");
  run->refusals.erase(from.source);
  delivered(*run, DeliveryKind::baton, from, body.tasks, body.epoch, step);
}

void SchedulerCore::handle(const NeedDefinition& body, const Inbound& from, Step step) {
  const Run* run = run_for(body.run, from, step);
  if (run == nullptr) return;
  if (!body.digest.bytes.empty() && body.digest != run->start().digest) {
    return refuse(from, fail(Errc::conflict, "run " + body.run + " has another definition"), step);
  }
  step.out.reply(from, Definition{run->record(), run->decision_records(), run->orders()});
}

void SchedulerCore::handle(const Definition& body, const Inbound& from, Step step) {
  const auto claimed = decode<RunStart>(body.start.payload.bytes);
  if (Run* known = claimed ? runs_.find(claimed->run) : nullptr) return take_more_decisions(*known, body, from, step);
  if (!claimed || !deferred_.waits(claimed->run, from.source)) {
    return refuse(from, fail(Errc::unknown_run, "a definition that nothing waits for"), step);
  }
  auto run = runs_.open(body.start);
  if (run && run->expired(step.steady)) run = expired_before(claimed->run);
  if (run && runs_.full()) run = no_place();
  if (!run) {
    step.out.log(LogLevel::warning, "definition_refused", "from '" + from.source + "': " + run.error().text());
    for (const Inbound& message : deferred_.take(claimed->run, from.source)) refuse(message, run.error(), step);
    return;
  }
  const std::string id = run->id();
  install(std::move(*run), body.start, false, step);
  if (auto taken = take_decisions(*runs_.find(id), body.decisions, step); !taken) {
    step.out.log(LogLevel::warning, "decisions_refused", "from '" + from.source + "': " + taken.error().text());
  }
  if (auto taken = take_orders(*runs_.find(id), body.orders, step); !taken) {
    step.out.log(LogLevel::warning, "orders_refused", "from '" + from.source + "': " + taken.error().text());
  }
  hand_out_deferred(id, step);
}

void SchedulerCore::take_more_decisions(Run& run, const Definition& body, const Inbound& from, Step step) {
  if (run.asked_decisions.erase(from.source) == 0 || body.start.payload != run.record().payload) {
    return refuse(from, fail(Errc::unknown_run, "a definition that nothing waits for"), step);
  }
  if (auto taken = take_decisions(run, body.decisions, step); !taken) {
    step.out.log(LogLevel::warning, "decisions_refused", "from '" + from.source + "': " + taken.error().text());
  }
  hand_out_deferred(run.id(), step);
}

void SchedulerCore::hand_out_deferred(const std::string& run, Step step) {
  // Nothing starts before the step's end: an abort among them comes before any start. Who has not told of the decision
  // that its message needs is not asked again.
  handing_out_ = true;
  for (const Inbound& message : deferred_.take(run)) dispatch(message, step);
  handing_out_ = false;
}

}  // namespace trb
