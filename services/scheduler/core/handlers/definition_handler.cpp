#include "services/scheduler/core/handlers/definition_handler.hpp"

#include "services/scheduler/core/refusal.hpp"

namespace trb::scheduler {
namespace {

Error unexpected() {
  return fail(Errc::unknown_run, "a definition that nothing waits for");
}

}  // namespace

/// The run is not expired, and there is room for it.
Status DefinitionHandler::check_new(const Run& run, Step step) const {
  if (run.definition().expired(step.steady)) {
    return fail(Errc::expired, "run " + run.id() + " has expired before it came here",
                "compare the nodes' clocks (trb doctor), or give it a longer life: --expires-h");
  }
  if (!runs_.full()) return Done{};
  return fail(Errc::queue_full, std::to_string(RunStore::kMaxRuns) + " runs are open here",
              "abort those that nobody needs: trb run list");
}

void DefinitionHandler::handle(const RunSubmit& body, const Inbound& from, Step step) {
  if (from.source != node_) {
    return refuse(from, fail(Errc::not_permitted, "a run is submitted on the submitter's own node"), step);
  }
  auto run = runs_.open(body.start);
  if (!run) return refuse(from, run.error(), step);
  const std::string id = (*run)->id();
  if (!(*run)->members().contains(node_)) {
    return refuse(from, fail(Errc::bad_value, "node '" + node_ + "' is no member of run " + id), step);
  }
  if (const auto over = lookup_.over(id)) return lookup_.refuse_over(id, *over, from, step);
  if (auto submitted = submit(std::move(*run), runs_.find(id), step); !submitted) {
    return refuse(from, submitted.error(), step);
  }
  step.out.reply(from, RunAccepted{id});
}

Status DefinitionHandler::submit(std::unique_ptr<Run> run, Run* known, Step step) {
  if (known == nullptr) {
    if (auto checked = check_new(*run, step); !checked) return checked;
    journal_.add(std::move(run), true, step);
    return Done{};
  }
  if (known->definition().record().payload != run->definition().record().payload) {
    return fail(Errc::conflict, "run " + run->id() + " is known with another start", "draw a new run id");
  }
  return known->deliveries().submitted_here() ? Done{} : journal_.note_submitted(*known, step);
}

void DefinitionHandler::handle(const NeedDefinition& body, const Inbound& from, Step step) {
  const Run* run = lookup_.find(body.run, from, step);
  if (run == nullptr) return;
  if (!body.digest.bytes.empty() && body.digest != run->definition().start().digest) {
    return refuse(from, fail(Errc::conflict, "run " + body.run + " has another definition"), step);
  }
  step.out.reply(from, Definition{run->definition().record(), run->epochs().records(), run->orders().records()});
}

void DefinitionHandler::handle(const Definition& body, const Inbound& from, Step step) {
  const auto claimed = decode<RunStart>(body.start.payload.bytes);
  if (Run* known = claimed ? runs_.find(claimed->run) : nullptr) return handle_more(*known, body, from, step);
  if (!claimed || !lookup_.awaits_definition(claimed->run, from.source)) return refuse(from, unexpected(), step);
  auto run = runs_.open(body.start);
  const Status checked = run ? check_new(**run, step) : Status(run.error());
  if (!checked) {
    step.out.log(LogLevel::warning, "definition_refused", "from '" + from.source + "': " + checked.error().text());
    return lookup_.refuse_deferred(claimed->run, from.source, checked.error(), step);
  }
  Run& added = journal_.add(std::move(*run), false, step);
  keep_decisions(added, body, from, step);
  if (auto kept = journal_.keep_orders(added, body.orders, step); !kept) {
    step.out.log(LogLevel::warning, "orders_refused", "from '" + from.source + "': " + kept.error().text());
  }
  lookup_.hand_out(added.id(), dispatch_, step);
}

/// The answer of a node that was asked for decisions.
void DefinitionHandler::handle_more(Run& run, const Definition& body, const Inbound& from, Step step) {
  const bool expected = run.work().requests().settle_decisions(from.source);
  if (!expected || body.start.payload != run.definition().record().payload) return refuse(from, unexpected(), step);
  keep_decisions(run, body, from, step);
  lookup_.hand_out(run.id(), dispatch_, step);
}

void DefinitionHandler::keep_decisions(Run& run, const Definition& body, const Inbound& from, Step step) {
  if (auto kept = journal_.keep_decisions(run, body.decisions, step); !kept) {
    step.out.log(LogLevel::warning, "decisions_refused", "from '" + from.source + "': " + kept.error().text());
  }
}

}  // namespace trb::scheduler
