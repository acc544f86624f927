#include "services/scheduler/core/scheduler_core.hpp"

#include "services/scheduler/core/named_run.hpp"

namespace trb {

using namespace scheduler;

SchedulerCore::SchedulerCore(SchedulerSettings settings, const Archive& archive)
    : settings_(std::move(settings)),
      archive_(archive),
      runs_(settings_.node, settings_.authority),
      executor_(settings_.node) {}

Status SchedulerCore::restore(std::span<const Body> records) {
  for (const Body& record : records) {
    if (const auto* time = get_if<JournalTime>(&record)) {
      steady_.restore({time->steady});
    } else if (const auto* lost = get_if<JournalLost>(&record)) {
      lost_.restore(*lost);
    } else if (auto applied = runs_.apply(record); !applied) {
      return applied;
    }
  }
  return Done{};
}

void SchedulerCore::on_welcome(const NodeIdentity& node, Now now, Outbox& out) {
  if (node.id != settings_.node) {
    out.log(LogLevel::error, "foreign_router",
            "the router is node '" + node.id + "', the keys are '" + settings_.node + "'");
    return;
  }
  for (Run* run : runs_.runs()) {
    run->deliveries.restart();
    for (auto& [task, need] : run->needs) need.timer.restart();
    for (Inquiry& inquiry : run->inquiries) inquiry.restart(now);
    for (auto& [task, signature] : run->skips) signature.next = now.mono;
    for (auto* signature : {&run->abort_signature, &run->hold_signature, &run->end_signature}) {
      if (*signature) (*signature)->next = now.mono;
    }
  }
  last_ = now;
  resume_attempt();
  if (settings_.has_robot) executor_.welcome(now, out);
  advance(step_at(now, out));
}

void SchedulerCore::on(const Inbound& message, Now now, Outbox& out) {
  const Step step = step_at(now, out);
  dispatch(message, step);
  advance(step);
}

void SchedulerCore::tick(Now now, Outbox& out) {
  advance(step_at(now, out));
}

std::optional<MonotonicTime> SchedulerCore::next_deadline() const {
  if (!last_) return std::nullopt;
  std::optional<MonotonicTime> out = earlier(executor_.next_deadline(), deferred_.next());
  out = earlier(earlier(out, steady_.next()), lost_.next());
  for (const Run* run : runs_.runs()) {
    out = earlier(out, run->deliveries.next());
    for (const auto& [task, need] : run->needs) out = earlier(out, need.timer.next());
    for (const Inquiry& inquiry : run->inquiries) out = earlier(out, inquiry.next());
    for (const auto& [task, signature] : run->skips) out = earlier(out, signature.next);
    for (const auto& [task, at] : run->retry_at) out = earlier(out, at);
    for (const auto& [task, at] : run->pass_at) out = earlier(out, at);
    for (const auto* signature : {&run->abort_signature, &run->hold_signature, &run->end_signature}) {
      if (*signature) out = earlier(out, (*signature)->next);
    }
    for (const auto& [task, at] : run->due_at) {
      const double within_s = run->tasks()[task].start_within_s;
      const MonotonicTime late = at + seconds(within_s);
      if (within_s > 0 && run->is_own(task) && late > last_->mono) out = earlier(out, late);
    }
    out = earlier(earlier(out, run->over_at), run->need_end.next());
    if (const auto end = run->next_end(last_steady_))
      out = earlier(out, last_->mono + Duration{end->ns - last_steady_.ns});
  }
  return out;
}

void SchedulerCore::dispatch(const Inbound& message, Step step) {
  const auto to_handler = [&](const auto& body) { handle(body, message, step); };
  if (Taken::dispatch(message.body, to_handler) || Answers::dispatch(message.body, to_handler)) return;
  refuse(message,
         fail(Errc::unknown_subtype, "the scheduler does not take '" + std::string(subtype_of(message.body)) + "'"),
         step);
}

void SchedulerCore::refuse(const Inbound& from, const Error& error, Step step) {
  // A counter for every subtype that a peer makes up would be a leak.
  const std::string subtype(holds_alternative<Opaque>(from.body) ? "opaque" : subtype_of(from.body));
  step.out.count("refused." + subtype + "." + std::string(errc_name(error.code)));
  step.out.nack(from, error, named_run(from.body));
}

void SchedulerCore::refuse_over(const std::string& run, const Over& over, const Inbound& from, Step step) {
  if (!over.end.kind.empty() && from.source != settings_.node) step.out.information(from.source, RunOver{over.end});
  refuse(from,
         fail(Errc::expired, "run " + run + " is over: " + std::string(name_of(over.state)), "trb run show has it"),
         step);
}

Run* SchedulerCore::run_for(const std::string& run, const Inbound& from, Step step) {
  Run* known = runs_.find(run);
  const auto over = known == nullptr ? archive_.over(run) : std::nullopt;
  if (over) {
    refuse_over(run, *over, from, step);
  } else if (known == nullptr) {
    refuse(from, fail(Errc::unknown_run, "run " + run + " is not known on '" + settings_.node + "'"), step);
  } else if (!known->is_member(from.source)) {
    refuse(from, fail(Errc::not_permitted, "'" + from.source + "' is no member of run " + run), step);
  } else {
    return known;
  }
  return nullptr;
}

Run* SchedulerCore::run_or_defer(const std::string& run, const Blob& digest, const Inbound& from, Step step) {
  const bool answer = from.reply_to != 0 || from.source == settings_.node;
  if (answer || runs_.find(run) != nullptr || archive_.over(run)) return run_for(run, from, step);
  if (runs_.full() || !deferred_.add(run, from, step.now.mono)) {
    refuse(from,
           fail(Errc::queue_full, "no place for run " + run + " on '" + settings_.node + "'",
                "end some of its " + std::to_string(runs_.runs().size()) + " open runs: trb run list"),
           step);
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
  const Status applied = runs_.add(std::move(run)).apply(fact);
  if (!applied) step.out.log(LogLevel::error, "run_not_applied", applied.error().text());
}

void SchedulerCore::delivered(Run& run, DeliveryKind kind, const Inbound& from, std::vector<TaskIndex> tasks,
                              std::uint32_t epoch, Step step) {
  if (!run.deliveries.settle(kind, from.source, tasks)) {
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
