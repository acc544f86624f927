#include "services/scheduler/core/scheduler_core.hpp"

#include "services/scheduler/core/delivery_sender.hpp"
#include "services/scheduler/core/late_binding.hpp"
#include "services/scheduler/core/refusal.hpp"
#include "services/scheduler/core/short_messages.hpp"

namespace trb {

using namespace scheduler;

namespace {

constexpr Duration kKeepTime = std::chrono::minutes(10);

template <class Handler>
bool offer_to(Handler& handler, const Inbound& message, Step step) {
  const auto handle = [&](const auto& body) { handler.handle(body, message, step); };
  bool taken = false;
  if constexpr (requires { typename Handler::Taken; }) taken = Handler::Taken::dispatch(message.body, handle);
  if constexpr (requires { typename Handler::Answers; }) {
    taken = taken || Handler::Answers::dispatch(message.body, handle);
  }
  return taken;
}

/// The run of a record that this node has requested the signature of. Errors: bad_value, malformed.
Result<std::string> run_that_signs(const SignedRecord& record) {
  if (record.kind == kSignedResult) return run_inside<TaskResult>(record);
  if (record.kind == kSignedChoice) return run_inside<Choice>(record);
  if (record.kind == kSignedRunAbort) return run_inside<AbortOrder>(record);
  if (record.kind == kSignedRunPause) return run_inside<PauseOrder>(record);
  if (record.kind == kSignedRunEnd) return run_inside<RunEnd>(record);
  return fail(Errc::bad_value, "a '" + record.kind + "' is nothing that a scheduler has signed");
}

}  // namespace

SchedulerCore::SchedulerCore(SchedulerSettings settings, const Archive& archive)
    : settings_(std::move(settings)),
      runs_(settings_.node, settings_.authority),
      executor_(settings_.node),
      lookup_(settings_.node, runs_, archive),
      journal_(settings_.node, runs_, lost_),
      definitions_(settings_.node, runs_, lookup_, journal_,
                   [this](const Inbound& message, Step step) { dispatch(message, step); }),
      batons_(settings_.node, runs_, executor_, lookup_, journal_),
      results_(runs_, lookup_, journal_),
      decisions_(settings_.node, lookup_, journal_),
      aborts_(settings_.node, runs_, executor_, lookup_, journal_),
      pauses_(settings_.node, executor_, lookup_, journal_),
      ends_(settings_.node, runs_, executor_, lookup_, journal_),
      queries_(runs_, archive, executor_, watchers_),
      robot_(settings_.node, runs_, executor_, lost_, journal_),
      conditions_(settings_.node, runs_, journal_),
      robots_(settings_.node, runs_),
      routes_(settings_.node, conditions_, definitions_, robots_),
      refusals_(settings_.node, runs_, executor_, conditions_, batons_, journal_),
      schedule_(runs_, executor_, lost_, settings_.identity_key),
      unattempted_(settings_.node, journal_),
      archiver_(settings_.has_robot, runs_, executor_, watchers_) {}

std::vector<std::string> SchedulerCore::subscriptions() {
  return {std::string(PeerJoined::kSubtype), std::string(PeerExpired::kSubtype), std::string(RevokedNodes::kSubtype)};
}

Status SchedulerCore::restore(std::span<const JournalRecord> records) {
  for (const JournalRecord& record : records) {
    if (const auto* time = std::get_if<JournalTime>(&record)) {
      steady_.restore({time->steady});
    } else if (const auto* lost = std::get_if<JournalLost>(&record)) {
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
  const Step step = step_at(now, out);
  for (Run* run : runs_.touch_all()) {
    run->deliveries().pending().restart();
    run->work().restart(now);
    run->recovery().restart();
    RobotSchedule::resume_pauses(*run, step);
  }
  last_ = now;
  schedule_.resume_attempt();
  if (settings_.has_robot) executor_.welcome(now, out);
  advance(step);
}

void SchedulerCore::on(const Inbound& message, Now now, Outbox& out) {
  const Step step = step_at(now, out);
  if (!is_short(message.body)) {
    dispatch(message, step);
  } else if (const auto whole = lengthened(message, runs_, step)) {
    dispatch(*whole, step);
  }
  advance(step);
}

void SchedulerCore::tick(Now now, Outbox& out) {
  advance(step_at(now, out));
}

template <class... Handlers>
bool SchedulerCore::offer(const Inbound& message, Step step, Handlers&... handlers) {
  return (offer_to(handlers, message, step) || ...);
}

void SchedulerCore::dispatch(const Inbound& message, Step step) {
  if (const auto* record = get_if<SignedRecord>(&message.body)) return handle_signed(*record, message, step);
  if (offer(message, step, batons_, results_, definitions_, decisions_, aborts_, pauses_, ends_, queries_, robot_,
            conditions_, routes_, refusals_)) {
    return;
  }
  refuse(message,
         fail(Errc::unknown_subtype, "the scheduler does not take '" + std::string(subtype_of(message.body)) + "'"),
         step);
}

/// The own router has signed what one of the handlers has requested.
void SchedulerCore::handle_signed(const SignedRecord& record, const Inbound& from, Step step) {
  if (from.source != settings_.node) return refuse(from, not_own(from), step);
  if (robot_.keep_signed(record, from, step)) return;
  const auto id = run_that_signs(record);
  Run* run = id ? runs_.find(*id) : nullptr;
  if (run != nullptr && keep_signed(*run, record, step)) return;
  step.out.count("late.signed_record");
}

bool SchedulerCore::keep_signed(Run& run, const SignedRecord& record, Step step) {
  return conditions_.keep_signed(run, record, step) || unattempted_.keep_signed(run, record, step) ||
         aborts_.keep_signed(run, record, step) || pauses_.keep_signed(run, record, step) ||
         ends_.keep_signed(run, record, step);
}

void SchedulerCore::advance(Step step) {
  if (!last_) return;                                 // not yet welcome: nothing can be sent
  if (step.steady < last_steady_) runs_.touch_all();  // what was past its time may not be
  last_ = step.now;
  last_steady_ = step.steady;
  keep_time(step);
  if (lost_.open()) report_lost_journal(step);
  lost_.watch_clock(step.now, step.out);
  touch_attempted();
  archive_runs(step);
  for (Run* run : runs_.due(step.clock())) {
    schedule_.update_due(*run, step);
    schedule_.fail_late(*run, step);
  }
  schedule_.permit_attempt(step);
  executor_.tick(step.now, step.out);
  if (settings_.has_robot) schedule_.start_next(step);
  touch_attempted();
  schedule_.notify_wait(step);
  for (Run* run : runs_.due(step.clock())) {
    advance(*run, step);
    plan_visit(*run);
    robots_.look(*run, step);
    ++visits_;
  }
  robots_.tick(step);
  next_of_runs_ = next_visit();
  lookup_.refuse_late(step);
  if (!watchers_.empty()) queries_.notify_watchers(step);
}

/// A handler is asked only in a run in which it may have something to do.
void SchedulerCore::advance(Run& run, Step step) {
  if (run.orders().is_aborted()) aborts_.confirm(run, step);
  if (run.definition().has_conditions()) conditions_.inquire(run, step);
  unattempted_.request(run, step);
  if (run.definition().aborts_on_failure()) aborts_.order_on_failure(run, step);
  if (run.epochs().judges_here()) {
    pauses_.hold_for_doubles(run, step);
    ends_.sign_end(run, step);
  } else {
    ends_.request_end(run, step);
  }
  send_due(run, step);
}

void SchedulerCore::archive_runs(Step step) {
  for (Run* run : runs_.due(step.clock())) {
    aborts_.give_up_revoked(*run, step);
    journal_.look_again(*run, step);
    if (run->is_open(step.steady)) {
      run->work().stay();
    } else {
      archiver_.archive_if_over(*run, step);
    }
  }
}

/// After a loss of power the time goes on from here.
void SchedulerCore::keep_time(Step step) {
  if (runs_.runs().empty() || (keep_time_at_ && *keep_time_at_ > step.now.mono)) return;
  keep_time_at_ = step.now.mono + kKeepTime;
  step.out.record(JournalTime{step.steady.ns});
}

void SchedulerCore::report_lost_journal(Step step) {
  if (settings_.has_robot) {
    lost_.tick(settings_.node, step.now, step.out);
  } else {
    lost_.close(step.out);
  }
}

std::optional<MonotonicTime> SchedulerCore::next_deadline() const {
  if (!last_) return std::nullopt;
  std::optional<MonotonicTime> out = earlier(executor_.next_deadline(), lookup_.next());
  out = earlier(earlier(out, steady_.next()), lost_.next());
  out = earlier(out, robots_.next_deadline());
  return earlier(out, next_of_runs_);
}

/// Its state follows the robot's, of which no fact of the run says anything.
void SchedulerCore::touch_attempted() {
  if (executor_.attempt()) (void)runs_.find(executor_.attempt()->execute.key.run);
}

void SchedulerCore::plan_visit(Run& run) const {
  std::optional<MonotonicTime> at = earlier(run.deliveries().pending().next(), run.work().next());
  if (run.is_recovering()) at = earlier(at, run.recovery().next(run.silent_members()));
  at = earlier(at, RobotSchedule::next_late(run, last_->mono));
  at = earlier(at, next_unbound_too_long(run, last_->mono));
  // What its visit has changed, its timers follow from the next step on.
  const bool again = !run.work().timers().are_of(run.timers_version());
  run.next_visit().set(again, at, run.definition().next_end(last_steady_));
}

std::optional<MonotonicTime> SchedulerCore::next_visit() const {
  std::optional<MonotonicTime> out;
  std::optional<UtcTime> end;
  for (const Run* run : runs_.runs()) {
    out = earlier(out, run->next_visit().at());
    const auto& ends = run->next_visit().end();
    if (ends && (!end || *ends < *end)) end = ends;
  }
  return end ? earlier(out, last_->mono + Duration{end->ns - last_steady_.ns}) : out;
}

}  // namespace trb
