#include "services/scheduler/core/scheduler_core.hpp"

namespace trb {

using namespace scheduler;

SchedulerCore::SchedulerCore(SchedulerSettings settings)
    : settings_(std::move(settings)), book_(settings_.node, settings_.authority), executor_(settings_.node) {}

std::vector<std::string> SchedulerCore::subtypes() {
  std::vector<std::string> out;
  for (const auto subtype : {RunSubmit::kSubtype,      Baton::kSubtype,
                             BatonJournaled::kSubtype, NeedDefinition::kSubtype,
                             Definition::kSubtype,     NeedResults::kSubtype,
                             Results::kSubtype,        ResultsJournaled::kSubtype,
                             TaskProgress::kSubtype,   RunAbort::kSubtype,
                             AbortConfirmed::kSubtype, RunQuery::kSubtype,
                             RunListRequest::kSubtype, AdapterState::kSubtype,
                             ExecutionState::kSubtype, Outcome::kSubtype,
                             RunDecision::kSubtype,    DecisionJournaled::kSubtype,
                             ReleaseTasks::kSubtype,   RunPause::kSubtype,
                             PauseJournaled::kSubtype, RunWatch::kSubtype}) {
    out.emplace_back(subtype);
  }
  return out;
}

Status SchedulerCore::restore(std::span<const Body> records) {
  for (const Body& record : records) {
    if (auto applied = book_.apply(record); !applied) return applied;
  }
  return Done{};
}

void SchedulerCore::on_welcome(const NodeIdentity& node, Now now, Outbox& out) {
  if (node.id != settings_.node) {
    out.log(LogLevel::error, "foreign_router",
            "the router is node '" + node.id + "', the keys are '" + settings_.node + "'");
    return;
  }
  for (Run* run : book_.runs()) {
    run->duties.restart();
    for (auto& [task, need] : run->needs) need.timer.restart();
    for (Inquiry& inquiry : run->inquiries) inquiry.restart(now);
    for (auto& [task, signature] : run->skips) signature.next = now.mono;
    if (run->abort_signature) run->abort_signature->next = now.mono;
  }
  last_ = now;
  resume_attempt();
  if (settings_.has_robot) executor_.welcome(now, out);
  advance({now, out});
}

void SchedulerCore::on(const Inbound& message, Now now, Outbox& out) {
  const Step step{now, out};
  book_.forget(now.utc);
  dispatch(message, step);
  advance(step);
}

void SchedulerCore::tick(Now now, Outbox& out) {
  advance({now, out});
}

std::optional<MonotonicTime> SchedulerCore::next_deadline() const {
  if (!last_) return std::nullopt;
  std::optional<MonotonicTime> out = earlier(executor_.next_deadline(), held_.next());
  for (const Run* run : book_.runs()) {
    out = earlier(out, run->duties.next());
    for (const auto& [task, need] : run->needs) out = earlier(out, need.timer.next());
    for (const Inquiry& inquiry : run->inquiries) out = earlier(out, inquiry.next());
    for (const auto& [task, signature] : run->skips) out = earlier(out, signature.next);
    for (const auto& [task, at] : run->retry_at) out = earlier(out, at);
    for (const auto& [task, at] : run->pass_at) out = earlier(out, at);
    if (run->abort_signature) out = earlier(out, run->abort_signature->next);
    if (const auto end = run->next_end(last_->utc)) out = earlier(out, last_->mono + Duration{end->ns - last_->utc.ns});
  }
  return out;
}

void SchedulerCore::dispatch(const Inbound& message, Step step) {
  visit([&](const auto& body) { handle(body, message, step); }, message.body);
}

template <class Other>
void SchedulerCore::handle(const Other& body, const Inbound& from, Step step) {
  refuse(from, fail(Errc::unknown_subtype, "the scheduler does not take '" + std::string(subtype_of(Body(body))) + "'"),
         step);
}

void SchedulerCore::refuse(const Inbound& from, const Error& error, Step step) {
  // A counter for every subtype that a peer makes up would be a leak.
  const std::string subtype(holds_alternative<Opaque>(from.body) ? "opaque" : subtype_of(from.body));
  step.out.count("refused." + subtype + "." + std::string(errc_name(error.code)));
  step.out.nack(from, error);
}

Run* SchedulerCore::run_for(const std::string& run, const Inbound& from, Step step) {
  Run* known = book_.find(run);
  if (book_.is_over(run)) {
    refuse(from, fail(Errc::expired, "run " + run + " is over"), step);
  } else if (known == nullptr) {
    refuse(from, fail(Errc::unknown_run, "run " + run + " is not known on '" + settings_.node + "'"), step);
  } else if (!known->is_member(from.source)) {
    refuse(from, fail(Errc::not_permitted, "'" + from.source + "' is no member of run " + run), step);
  } else {
    return known;
  }
  return nullptr;
}

Run* SchedulerCore::run_or_hold(const std::string& run, const Blob& digest, const Inbound& from, Step step) {
  const bool answer = from.reply_to != 0 || from.source == settings_.node;
  if (answer || book_.find(run) != nullptr || book_.is_over(run)) return run_for(run, from, step);
  if (book_.full() || !held_.add(run, from, step.now.mono)) {
    refuse(from, fail(Errc::queue_full, "no place for run " + run + " on '" + settings_.node + "'"), step);
  } else {
    step.out.request(from.source, NeedDefinition{run, digest});
  }
  return nullptr;
}

void SchedulerCore::install(Run run, const SignedRecord& start, bool submitted_here, Step step) {
  const JournalRun fact{start, submitted_here};
  step.out.record(fact);
  step.out.log(
      LogLevel::info, "run_known",
      "run " + run.id() + " of '" + run.start().submitter + "': " + std::to_string(run.tasks().size()) + " tasks");
  const Status applied = book_.add(std::move(run)).apply(fact);
  if (!applied) step.out.log(LogLevel::error, "run_not_applied", applied.error().text());
}

void SchedulerCore::delivered(Run& run, DutyKind kind, const Inbound& from, std::vector<TaskIndex> tasks,
                              std::uint32_t epoch, Step step) {
  if (!run.duties.settle(kind, from.source, tasks)) {
    step.out.count("late." + std::string(subtype_of(from.body)));
    return;
  }
  JournalDelivered fact;
  fact.run = run.id();
  fact.to = from.source;
  fact.what = name_of(kind);
  fact.tasks = std::move(tasks);
  fact.epoch = epoch;
  step.out.record(fact);
  if (auto applied = run.apply(fact); !applied) {
    step.out.log(LogLevel::error, "delivery_not_applied", applied.error().text());
  }
}

}  // namespace trb
