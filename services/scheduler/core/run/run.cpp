#include "services/scheduler/core/run/run.hpp"

#include <algorithm>

namespace trb::scheduler {
namespace {

constexpr DeliveryKind kDeliveryKinds[] = {DeliveryKind::baton, DeliveryKind::results, DeliveryKind::abort,
                                           DeliveryKind::decision, DeliveryKind::pause};

Status not_of_this_run(const std::string& run, std::string_view what) {
  return fail(Errc::conflict, "run " + run + ": " + std::string(what) + " is not of this run");
}

}  // namespace

Result<std::unique_ptr<Run>> Run::open(const SignedRecord& record, const std::shared_ptr<Certificates>& certificates,
                                       const std::string& self) {
  auto definition = RunDefinition::open(record, *certificates);
  if (!definition) return definition.error();
  auto members = Members::open(*definition, *certificates);
  if (!members) return members.error();
  return std::unique_ptr<Run>(new Run(std::move(*definition), std::move(*members), certificates, self));
}

Run::Run(RunDefinition definition, Members members, const std::shared_ptr<Certificates>& certificates,
         const std::string& self)
    : certificates_(certificates),
      definition_(std::move(definition)),
      members_(std::move(members)),
      epochs_(definition_, self),
      facts_(definition_, epochs_),
      reports_(definition_.tasks().size()),
      deliveries_(definition_, members_, epochs_, facts_),
      open_tasks_({definition_, epochs_, facts_, reports_, deliveries_, work_}),
      checks_(definition_, members_, epochs_),
      decision_checks_(definition_, members_, epochs_, *certificates_) {}

Status Run::apply(const JournalRun& fact) {
  if (fact.start.payload != definition_.record().payload) return not_of_this_run(id(), "a start");
  if (!fact.submitted_here || deliveries_.submitted_here()) return Done{};
  deliveries_.note_submitted();
  ++version_;
  if (!orders_.is_aborted()) deliveries_.owe_first_batons();
  return Done{};
}

Status Run::apply(const JournalStart& fact) {
  const auto task = index_of(fact.key.task);
  const bool ours = task && fact.epoch >= 1 && fact.epoch <= epochs_.current() &&
                    epochs_.robot_in(*task, fact.epoch) == epochs_.self();
  if (!ours) return not_of_this_run(id(), "a start record");
  facts_.add(*task, fact);
  ++version_;
  return Done{};
}

Status Run::apply(const JournalResult& fact) {
  auto held = checks_.result(fact.result);
  if (!held) return held.error();
  add(std::move(*held));
  return Done{};
}

bool Run::add(HeldResult held) {
  const TaskIndex task = *index_of(held.result.key.task);
  const bool was_final = results().has_final(task);
  const bool own = held.result.robot == epochs_.self();
  const bool by_its_robot = held.result.robot == epochs_.robot_of(task);
  const bool was_double = results().finished_twice(task);
  if (!facts_.add(task, std::move(held))) return false;
  ++version_;
  const bool is_final = results().has_final(task);
  const bool is_double = !was_double && results().finished_twice(task);
  if (is_double) orders_.note_double(tasks()[task].id);
  if (is_final) work_.awaited().drop_result(task);
  if (by_its_robot || is_final) reports_.forget_progress(task);
  if (facts_.current(task) != nullptr) {
    work_.withheld().drop_failing(task);
    work_.timers().drop_retry(task);
  }
  if (own || is_double) deliveries_.owe_result(task);
  deliveries_.owe_late_result(task);
  if (!was_final && is_final && !orders_.is_aborted()) deliveries_.owe_batons_after(task);
  return true;
}

Status Run::apply(const JournalChoice& fact) {
  auto held = checks_.choice(fact.choice);
  if (!held) return held.error();
  add(std::move(*held));
  return Done{};
}

bool Run::add(HeldChoice held) {
  const auto shared = std::make_shared<const HeldChoice>(std::move(held));
  const std::vector<TaskIndex> fresh = facts_.add(shared);
  for (const TaskIndex task : fresh) reports_.forget_wait(task);
  version_ += fresh.size();
  if (shared->choice.by == epochs_.self() && !orders_.is_aborted()) deliveries_.owe_batons(fresh);
  return !fresh.empty();
}

Status Run::apply(const JournalDelivered& fact) {
  for (const TaskIndex task : fact.tasks) {
    if (task >= tasks().size()) return not_of_this_run(id(), "a delivery");
  }
  for (const DeliveryKind kind : kDeliveryKinds) {
    if (fact.what == name_of(kind)) deliveries_.settle(kind, fact.to, fact.tasks);
  }
  if (fact.what == kRecovers) recovery_.open();
  if (fact.what == kFirstPass) recovery_.note_first_pass();
  if (fact.what == kHasTold) note_told(fact.to);
  if (fact.what == name_of(DeliveryKind::baton)) deliveries_.note_passed(fact.tasks, fact.to, fact.epoch);
  return Done{};
}

bool Run::has_signed() const {
  const std::string& self = epochs_.self();
  const auto is_own = [&](TaskIndex task) {
    const HeldChoice* choice = facts_.choice_on(task);
    const HeldResult* result = results().of(task);
    return (choice != nullptr && choice->choice.by == self) || (result != nullptr && result->result.robot == self);
  };
  for (std::size_t task = 0; task < tasks().size(); ++task) {
    if (is_own(static_cast<TaskIndex>(task))) return true;
  }
  return epochs_.current() > 1 || (orders_.pause() != nullptr && orders_.pause()->by == self);
}

/// By this node's own name: nobody needs to be asked.
void Run::note_told(const std::string& member) {
  recovery_.note_told(member);
  if (!recovery_.is_open() || (member != epochs_.self() && !silent_members().empty())) return;
  recovery_.close();
  ++version_;
  deliveries_.pending().restart();  // what was held back is due
}

Status Run::apply(const JournalDecision& fact) {
  const auto decision = decision_checks_.decision(fact.decision);
  if (!decision) return decision.error();
  adopt(fact.decision, *decision);
  ++version_;
  // What the decider has back from one member others may not have: it was owed to them by a journal that was lost.
  if (fact.decided_here || epochs_.decides_here()) deliveries_.owe_to_members(DeliveryKind::decision);
  return Done{};
}

void Run::adopt(const SignedRecord& record, const Decision& decision) {
  const auto added = members_.open_new(decision, *certificates_);
  for (const auto& [member, certificate] : *added) {
    if (orders_.pause() != nullptr) deliveries_.pending().owe(DeliveryKind::pause, member, {});
    if (orders_.is_aborted()) deliveries_.pending().owe(DeliveryKind::abort, member, {});
  }
  members_.add(decision, *added);
  epochs_.adopt(record, decision);
  for (const TaskRuling& ruling : decision.tasks) {
    const TaskIndex task = *index_of(ruling.task);
    work_.begin_anew(task);
    reports_.forget_progress(task);
    reports_.forget_wait(task);
  }
  if (orders_.is_open()) deliveries_.owe_batons_anew();
}

Status Run::apply(const JournalAbort& fact) {
  if (auto order = checks_.abort(fact.order); !order) return order.error();
  if (orders_.is_aborted()) return Done{};
  orders_.abort(fact.order);
  ++version_;
  work_.signatures().drop(PendingSignatures::RunRecord::abort);
  deliveries_.pending().drop(DeliveryKind::baton);
  work_.awaited().drop_results();
  work_.timers().drop_retries();
  deliveries_.owe_to_members(DeliveryKind::abort);
  return Done{};
}

Status Run::apply(const JournalPause& fact) {
  auto order = checks_.pause(fact.order);
  if (!order) return order.error();
  // An earlier version has journaled doubles of any member's.
  if (!checks_.check_doubles(*order) || !orders_.is_newer(*order)) return Done{};
  orders_.adopt(fact.order, std::move(*order));
  ++version_;
  work_.signatures().drop(PendingSignatures::RunRecord::hold);
  deliveries_.pending().drop(DeliveryKind::pause);
  deliveries_.owe_to_members(DeliveryKind::pause);
  return Done{};
}

std::uint32_t Run::pause_number() const {
  const PauseOrder* known = orders_.pause();
  if (known == nullptr) return 0;
  const bool overrides =
      !known->paused && !checks_.outranks_robots(known->by) && checks_.outranks_robots(epochs_.self());
  return overrides ? std::max(known->number, kMaxRobotResume) : known->number;
}

Status Run::apply(const JournalEnd& fact) {
  if (auto end = checks_.end(fact.end); !end) return end.error();
  if (orders_.has_ended()) return Done{};
  orders_.end(fact.end);
  ++version_;
  work_.signatures().drop(PendingSignatures::RunRecord::end);
  work_.awaited().drop_results();
  work_.timers().drop_retries();
  for (const DeliveryKind kind : kDeliveryKinds) {
    if (kind != DeliveryKind::results) deliveries_.pending().drop(kind);
  }
  return Done{};
}

Result<HeldResult> Run::received_result(const SignedRecord& record) const {
  auto held = checks_.received_result(record);
  if (!held || results().bytes_of(held->result.robot) <= ResultSet::kMostBytes) return held;
  const TaskIndex task = *index_of(held->result.key.task);
  // What others hold of that robot comes with their batons: it does no harm if nothing is journaled of it.
  if (!results().grows_by(task, *held)) return held;
  return fail(Errc::too_large, "run " + id() + ": '" + held->result.robot + "' has results of over 4 MiB in it",
              "let its skills answer with less data");
}

void Run::await_retry(TaskIndex task, MonotonicTime now, UtcTime steady) {
  const auto at = facts_.tried_again_at(task);
  if (!at || !orders_.is_open()) return;
  const Duration pause = facts_.retry_pause(task);
  const Duration left = epochs_.is_own(task) ? pause : std::min(Duration{at->ns - steady.ns}, pause);
  if (left > Duration{0} || epochs_.is_own(task)) work_.timers().retry_at(task, now + left);
}

void Run::receive(const std::vector<bool>& final_tasks, const std::vector<bool>& skipped_tasks,
                  const std::string& giver) {
  // Any member may repeat a baton as often as it likes: that says nothing new to those who watch the run.
  if (reports_.add(final_tasks, skipped_tasks)) ++version_;
  const std::string& judge = definition_.rule().judge();
  for (const TaskIndex task : open_tasks_.missing_results(reported_final())) {
    work_.awaited().need_result(task, giver, judge);
  }
}

std::vector<bool> Run::reported_final() const {
  std::vector<bool> out = results().final_tasks(tasks().size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = out[i] || reports_.final_tasks()[i];
  return out;
}

std::vector<bool> Run::known_final() const {
  // Where alerts and decisions come from, no member's word on another's task counts: each result comes here by itself.
  const bool proves = epochs_.judges_here() || epochs_.decides_here();
  return proves ? results().final_tasks(tasks().size()) : reported_final();
}

std::vector<bool> Run::known_skipped() const {
  std::vector<bool> out = reports_.skipped_tasks();
  for (const TaskIndex task : results().tasks()) {
    if (results().has_final(task)) out[task] = results().is_skipped(task);
  }
  return out;
}

bool Run::may_start(UtcTime steady) const {
  return is_open(steady) && !orders_.is_held() && !orders_.has_new_double() && !recovery_.is_open();
}

bool Run::is_idle() const {
  return (open_tasks_.own_are_final() || is_stuck()) && deliveries_.pending().empty() && work_.is_empty();
}

/// A task has failed here, and none could begin: its decision may have come, and the run ended, while this node was
/// away.
bool Run::is_stuck() const {
  return open_tasks_.own_has_failed() && open_tasks_.startable().empty();
}

}  // namespace trb::scheduler
