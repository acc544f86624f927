#include "services/scheduler/core/run.hpp"

#include <algorithm>

#include "common/scenario/run_start.hpp"
#include "proto/body.hpp"

namespace trb::scheduler {
namespace {

const Member* find_member(const RunStart& start, const std::string& id) {
  const auto found =
      std::find_if(start.members.begin(), start.members.end(), [&](const Member& member) { return member.id == id; });
  return found == start.members.end() ? nullptr : &*found;
}

Result<Certificate> open_member(const Member& member, Certificates& certificates) {
  auto certificate = certificates.open(member.certificate);
  if (!certificate) return certificate;
  if (certificate->id != member.id) {
    return fail(Errc::source_mismatch, "member '" + member.id + "' has the certificate of '" + certificate->id + "'");
  }
  return certificate;
}

Result<RunStart> open_signed_start(const SignedRecord& record, Certificates& certificates) {
  const auto claimed = decode<RunStart>(record.payload.bytes);
  if (!claimed) return claimed.error();
  if (record.signer != claimed->submitter) {
    return fail(Errc::source_mismatch, "run_start signed by '" + record.signer + "', not by its submitter");
  }
  const Member* submitter = find_member(*claimed, record.signer);
  if (submitter == nullptr)
    return fail(Errc::not_permitted, "submitter '" + record.signer + "' is no member of the run");
  const auto certificate = open_member(*submitter, certificates);
  if (!certificate) return certificate.error();
  return open_record<RunStart>(record, kSignedRunStart, *certificate);
}

}  // namespace

Result<Run> Run::open(const SignedRecord& record, const std::shared_ptr<Certificates>& certificates,
                      const std::string& self) {
  auto start = open_signed_start(record, *certificates);
  if (!start) return start.error();
  if (auto checked = check_run_start(*start); !checked) return checked.error();
  Run run;
  run.self_ = self;
  run.certificates_ = certificates;
  run.record_ = record;
  run.start_ = std::move(*start);
  if (auto members = run.open_members(); !members) return members.error();
  run.index_tasks();
  return run;
}

Status Run::open_members() {
  for (const Member& member : start_.members) {
    auto certificate = open_member(member, *certificates_);
    if (!certificate) return certificate.error();
    if (decider_.empty() && certificate->role == Role::cloud) decider_ = member.id;
    members_.emplace(member.id, std::move(*certificate));
    member_ids_.push_back(member.id);
  }
  for (std::size_t i = 0; i < tasks().size(); ++i) {
    const bool bound_late = tasks()[i].robot.empty() && start_.first.robots[i] == decider_;
    if (bound_late || members_.at(start_.first.robots[i]).role == Role::robot) continue;
    return fail(Errc::bad_value, "task '" + tasks()[i].id + "' is assigned to '" + start_.first.robots[i] +
                                     "', which is no robot's node");
  }
  return Done{};
}

void Run::index_tasks() {
  robots_ = start_.first.robots;
  since_.assign(tasks().size(), 1);
  first_attempt_.assign(tasks().size(), 1);
  heard_.assign(tasks().size(), false);
  heard_skipped_ = heard_;
  successors_ = successors_of(start_.scenario);
  for (std::size_t i = 0; i < tasks().size(); ++i) {
    const auto task = static_cast<TaskIndex>(i);
    index_.emplace(tasks()[i].id, task);
    has_conditions_ = has_conditions_ || is_conditional(task);
    skips_on_failure_ =
        skips_on_failure_ || tasks()[i].on_failure == OnFailure::skip || tasks()[i].on_failure == OnFailure::continue_;
    aborts_on_failure_ = aborts_on_failure_ || tasks()[i].on_failure == OnFailure::abort;
  }
  index_own_tasks();
}

std::optional<TaskIndex> Run::index_of(const std::string& task) const {
  const auto found = index_.find(task);
  if (found == index_.end()) return std::nullopt;
  return found->second;
}

std::vector<std::string> Run::clouds() const {
  std::vector<std::string> out;
  for (const Member& member : start_.members) {
    if (member.id != self_ && members_.at(member.id).role == Role::cloud) out.push_back(member.id);
  }
  return out;
}

Result<HeldResult> Run::check_result(const SignedRecord& record) const {
  const auto signer = members_.find(record.signer);
  if (signer == members_.end()) {
    return fail(Errc::not_permitted, "run " + id() + ": '" + record.signer + "' is no member");
  }
  auto result = open_record<TaskResult>(record, kSignedResult, signer->second);
  if (!result) return result.error();
  const auto task = index_of(result->key.task);
  const std::string name = "run " + id() + ": result of task '" + result->key.task + "': ";
  if (result->key.run != id() || result->digest != start_.digest) return fail(Errc::conflict, name + "of another run");
  if (result->epoch == 0 || result->epoch > epoch()) return fail(Errc::conflict, name + "of another epoch");
  if (!task) return fail(Errc::bad_value, name + "no such task");
  const std::uint32_t attempt = result->key.attempt;
  const bool skipped = result->outcome == TaskOutcome::skipped;
  const std::uint32_t most = kMaxAttempts + (skipped ? 1 : 0);
  if (result->key.iteration != 1 || attempt == 0 || attempt > most || result->outcome == TaskOutcome::none) {
    return fail(Errc::bad_value, name + "no such attempt or outcome");
  }
  if (result->goes_on && !(skipped && tasks()[*task].on_failure == OnFailure::continue_)) {
    return fail(Errc::bad_value, name + "nothing goes on behind it");
  }
  if (result->robot != record.signer || robot_in(*task, result->epoch) != record.signer) {
    return fail(Errc::not_permitted, name + "'" + record.signer + "' is not its robot");
  }
  // A cloud node does nothing: its task is one that a decision skips, or one that a decision has yet to give a robot.
  const bool gives_up = result->outcome == TaskOutcome::released && attempt == 1;
  if (signer->second.role == Role::cloud && result->outcome != TaskOutcome::skipped && !gives_up) {
    return fail(Errc::not_permitted, name + "'" + record.signer + "' can only skip it");
  }
  return HeldResult{record, std::move(*result)};
}

std::optional<UtcTime> Run::next_end(UtcTime steady) const {
  if (!expired(steady)) return UtcTime{start_.expires};
  if (steady < buried_until()) return buried_until();
  return std::nullopt;
}

Attempt Run::attempt_for(const JournalStart& fact) const {
  const TaskIndex index = *index_of(fact.key.task);
  const Task& task = tasks()[index];
  Attempt attempt;
  const auto data = data_for(index);
  attempt.execute = {fact.key, fact.epoch, fact.instance, task.skill, data ? *data : task.data, task.timeout_s};
  const std::uint32_t first = std::min(first_attempt_[index], fact.key.attempt);
  attempt.may_retry = fact.key.attempt - first < task.retries && fact.key.attempt < kMaxAttempts;
  attempt.on_failure = task.on_failure;
  attempt.result.key = fact.key;
  attempt.result.digest = start_.digest;
  attempt.result.epoch = fact.epoch;
  attempt.result.robot = self_;
  attempt.result.started = fact.time;
  return attempt;
}

bool Run::all_final() const {
  for (std::size_t i = 0; i < tasks().size(); ++i) {
    if (!results_.has_final(static_cast<TaskIndex>(i))) return false;
  }
  return true;
}

std::vector<TaskIndex> Run::problems() const {
  std::vector<TaskIndex> out;
  for (const TaskIndex task : results_.tasks()) {
    const HeldResult* held = current(task);
    const bool stands = held != nullptr && !is_final(held->result.outcome) && !is_unbound(task);
    if (stands && !ends_run(task, held->result)) out.push_back(task);
  }
  return out;
}

bool Run::ends_run(TaskIndex task, const TaskResult& result) const {
  return tasks()[task].on_failure == OnFailure::abort &&
         (result.outcome == TaskOutcome::failed || result.outcome == TaskOutcome::interrupted);
}

std::optional<TaskIndex> Run::ending_task() const {
  if (!aborts_on_failure_) return std::nullopt;
  for (const TaskIndex task : results_.tasks()) {
    const HeldResult* held = current(task);
    const bool says = held != nullptr && (held->result.robot == self_ || self_ == judge());
    if (says && ends_run(task, held->result)) return task;
  }
  return std::nullopt;
}

std::vector<TaskIndex> Run::due() const {
  std::vector<TaskIndex> out;
  const bool knows_all = self_ == judge();
  for (std::size_t i = 0; i < tasks().size(); ++i) {
    const auto task = static_cast<TaskIndex>(i);
    if (results_.has_final(task) || current(task) != nullptr || progress.contains(task)) continue;
    const bool ours = robot_of(task) == self_;
    if (!ours && !knows_all && !deliveries.owes_baton(task)) continue;
    if (ours && (begun(task) || unbegun.contains(task))) continue;
    if (all_before_final(task) && fate_of(task) == Fate::goes) out.push_back(task);
  }
  return out;
}

std::vector<TaskIndex> Run::choosing_elsewhere() const {
  std::vector<TaskIndex> out;
  if (self_ != judge()) return out;
  for (std::size_t i = 0; i < tasks().size(); ++i) {
    const auto task = static_cast<TaskIndex>(i);
    const bool open = is_conditional(task) && !chooses_here(task) && current(task) == nullptr;
    if (open && all_before_final(task) && fate_of(task) == Fate::undecided) out.push_back(task);
  }
  return out;
}

bool Run::is_idle() const {
  const bool done =
      std::all_of(own_tasks_.begin(), own_tasks_.end(), [&](TaskIndex task) { return results_.has_final(task); });
  return done && deliveries.empty() && needs.empty() && skips.empty() && inquiries.empty();
}

bool Run::wants_robot(TaskIndex task) const {
  return is_unbound(task) && results_.of(task) != nullptr && !results_.has_final(task);
}

const JournalStart* Run::open_start() const {
  for (const auto& [task, start] : starts_) {
    if (!results_.holds(task, start.key, self_)) return &start;
  }
  return nullptr;
}

std::vector<bool> Run::known_final() const {
  std::vector<bool> out = results_.final_tasks(tasks().size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = out[i] || heard_[i];
  return out;
}

std::vector<bool> Run::known_skipped() const {
  std::vector<bool> out = heard_skipped_;
  for (const TaskIndex task : results_.tasks()) {
    if (results_.has_final(task)) out[task] = results_.is_skipped(task);
  }
  return out;
}

void Run::hear(const std::vector<bool>& final_tasks, const std::vector<bool>& skipped_tasks) {
  for (std::size_t i = 0; i < heard_.size(); ++i) {
    heard_[i] = heard_[i] || final_tasks[i];
    heard_skipped_[i] = heard_skipped_[i] || (final_tasks[i] && skipped_tasks[i]);
  }
  ++version_;
}

void Run::note_needs(const std::string& giver) {
  const std::vector<bool> known = known_final();
  for (const TaskIndex task : concern_) {
    if (current(task) != nullptr || !predecessors_final(tasks()[task], known)) continue;
    for (const TaskIndex before : tasks()[task].after) {
      if (!results_.has_final(before)) needs.try_emplace(before, Need{giver, {}});
    }
  }
}

void Run::forget_needs(const std::string& giver) {
  std::erase_if(needs, [&](const auto& need) { return need.second.giver == giver; });
}

}  // namespace trb::scheduler
