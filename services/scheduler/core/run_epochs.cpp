// Run: its epochs. A decision says whose a task is from now on; what has ended before is void, unless it is final.
#include <algorithm>
#include <set>

#include "common/scenario/values.hpp"
#include "common/security/keys.hpp"
#include "proto/body.hpp"
#include "services/scheduler/core/run.hpp"

namespace trb::scheduler {
namespace {

constexpr std::size_t kRecordOverhead = 256;
constexpr std::size_t kDefinitionOverhead = 4096;

const TaskRuling* find_ruling(const Decision& decision, const std::string& task) {
  const auto at = std::find_if(decision.tasks.begin(), decision.tasks.end(),
                               [&](const TaskRuling& ruling) { return ruling.task == task; });
  return at == decision.tasks.end() ? nullptr : &*at;
}

}  // namespace

const std::string& Run::robot_in(TaskIndex task, std::uint32_t epoch) const {
  for (std::size_t i = std::min<std::size_t>(decisions_.size(), epoch == 0 ? 0 : epoch - 1); i > 0; --i) {
    if (const TaskRuling* ruling = find_ruling(decisions_[i - 1], tasks()[task].id)) return ruling->robot;
  }
  return start_.first.robots[task];
}

Result<Decision> Run::check_decision(const SignedRecord& record) const {
  const std::string name = "run " + id() + ": decision: ";
  if (decider_.empty() || record.signer != decider_) {
    return fail(Errc::not_permitted, name + "'" + record.signer + "' is not its decider" +
                                         (decider_.empty() ? "; it has none" : ", '" + decider_ + "' is"));
  }
  auto decision = open_record<Decision>(record, kSignedDecision, members_.at(decider_));
  if (!decision) return decision.error();
  if (decision->by != decider_) return fail(Errc::source_mismatch, name + "it names another node");
  if (decision->run != id() || decision->digest != start_.digest) return fail(Errc::conflict, name + "of another run");
  if (decision->epoch != epoch() + 1) {
    return fail(Errc::conflict, name + "epoch " + std::to_string(decision->epoch) + " does not follow epoch " +
                                    std::to_string(epoch()));
  }
  const Bytes before = decision_records_.empty() ? Bytes{} : digest(decision_records_.back().payload.bytes);
  if (decision->previous.bytes != before) return fail(Errc::conflict, name + "it is not built on the one before");
  if (decisions_.size() >= kMaxDecisions) return fail(Errc::too_large, name + "there are 64 already", "abort the run");
  // A member that comes late is told all of it in one message.
  std::size_t size = record_.payload.bytes.size() + record.payload.bytes.size();
  for (const SignedRecord& one : decision_records_) size += one.payload.bytes.size() + kRecordOverhead;
  if (size > kMaxDataSize - kDefinitionOverhead) {
    return fail(Errc::too_large, name + "with the ones before it has no place in a message", "abort the run");
  }
  if (decision->tasks.empty()) return fail(Errc::bad_value, name + "on no task");
  if (auto added = open_new_members(*decision); !added) return added.error();
  std::set<std::string> seen;
  for (const TaskRuling& ruling : decision->tasks) {
    if (!seen.insert(ruling.task).second) {
      return fail(Errc::duplicate, name + "task '" + ruling.task + "' occurs twice");
    }
    if (auto checked = check_ruling(*decision, ruling); !checked) return checked.error();
  }
  return decision;
}

Result<std::map<std::string, Certificate>> Run::open_new_members(const Decision& decision) const {
  std::map<std::string, Certificate> out;
  for (const Member& member : decision.members) {
    const std::string name = "run " + id() + ": decision: member '" + member.id + "' ";
    auto certificate = certificates_->open(member.certificate);
    if (!certificate) return certificate.error();
    if (certificate->id != member.id) {
      return fail(Errc::source_mismatch, name + "has the certificate of '" + certificate->id + "'");
    }
    if (certificate->role != Role::robot) return fail(Errc::bad_value, name + "is no robot's node");
    if (is_member(member.id) || !out.emplace(member.id, *certificate).second) {
      return fail(Errc::duplicate, name + "is one already");
    }
  }
  return out;
}

Status Run::check_ruling(const Decision& decision, const TaskRuling& ruling) const {
  const std::string name = "run " + id() + ": decision: task '" + ruling.task + "': ";
  const auto task = index_of(ruling.task);
  if (!task) return fail(Errc::bad_value, name + "no such task");
  // Where all attempts are used up it can still be skipped.
  const std::uint32_t most = kMaxAttempts + (ruling.ruling == Ruling::skip ? 1 : 0);
  if (ruling.attempt <= first_attempt_[*task] || ruling.attempt > most) {
    return fail(Errc::bad_value,
                name + "attempt " + std::to_string(ruling.attempt) + " is not one of " +
                    std::to_string(first_attempt_[*task] + 1) + " to " + std::to_string(most),
                "skip it, or abort the run");
  }
  const auto known = members_.find(ruling.robot);
  const bool added = std::any_of(decision.members.begin(), decision.members.end(),
                                 [&](const Member& member) { return member.id == ruling.robot; });
  const bool is_robot = added || (known != members_.end() && known->second.role == Role::robot);
  const bool stays = ruling.robot == robot_of(*task);
  switch (ruling.ruling) {
    case Ruling::move:
      if (!is_robot || stays)
        return fail(Errc::bad_value, name + "'" + ruling.robot + "' is no other robot of the run");
      if (tasks()[*task].pinned && !is_unbound(*task))
        return fail(Errc::not_permitted, name + "it is pinned to '" + robot_of(*task) + "'");
      break;
    case Ruling::retry:
      if (!is_robot || !stays) return fail(Errc::bad_value, name + "'" + ruling.robot + "' is not its robot");
      break;
    case Ruling::skip:
      if (ruling.robot != decider_) return fail(Errc::bad_value, name + "what is skipped goes to the decider's node");
      break;
  }
  return Done{};
}

Status Run::check_grounds(const Decision& decision) const {
  for (const TaskRuling& ruling : decision.tasks) {
    const TaskIndex task = *index_of(ruling.task);
    const std::string name = "run " + id() + ": decision: task '" + ruling.task + "' ";
    const HeldResult* held = current(task);
    if (results_.has_final(task)) {
      return fail(Errc::conflict, name + "is " + std::string(name_of(held->result.outcome)) + " already",
                  "look at the run, decide anew");
    }
    if (held != nullptr && ends_run(task, held->result)) {
      return fail(Errc::conflict, name + "has failed, and that ends the run");
    }
    if (ruling.evidence == Evidence::result && held == nullptr) {
      return fail(Errc::conflict, name + "has not been given up by '" + robot_of(task) + "'",
                  "ask it back, or give your word that the robot stands");
    }
    // Who is silent may have tried again as often as the task says.
    const std::uint32_t tried = first_attempt_[task] + tasks()[task].retries;
    const std::uint32_t next = ruling.evidence == Evidence::word ? tried + 1 : next_attempt(task);
    if (ruling.attempt < next) {
      return fail(Errc::conflict, name + "may have come to attempt " + std::to_string(next - 1),
                  "number it " + std::to_string(next));
    }
  }
  return Done{};
}

Status Run::apply(const JournalDecision& fact) {
  auto decision = check_decision(fact.decision);
  if (!decision) return decision.error();
  decision_records_.push_back(fact.decision);
  adopt(*decision);
  ++version_;
  if (fact.decided_here) owe_to_members(DeliveryKind::decision);
  return Done{};
}

void Run::adopt(const Decision& decision) {
  const auto added = open_new_members(decision);
  for (const auto& [member, certificate] : *added) {
    members_.emplace(member, certificate);
    if (pause_) deliveries.owe(DeliveryKind::pause, member, {});
    if (abort_) deliveries.owe(DeliveryKind::abort, member, {});
  }
  for (const Member& member : decision.members) member_ids_.push_back(member.id);
  decisions_.push_back(decision);
  for (const TaskRuling& ruling : decision.tasks) {
    const TaskIndex task = *index_of(ruling.task);
    if (ruling.evidence == Evidence::word) standing_.insert(robots_[task]);
    robots_[task] = ruling.robot;
    since_[task] = decision.epoch;
    first_attempt_[task] = ruling.attempt;
    asked_back.erase(task);
    unbegun.erase(task);
    retry_at.erase(task);
    progress.erase(task);
    waits.erase(task);
  }
  index_own_tasks();
  if (!aborted() && !ended()) owe_batons_anew();
}

void Run::index_own_tasks() {
  own_tasks_.clear();
  concern_.clear();
  for (std::size_t i = 0; i < tasks().size(); ++i) {
    const auto task = static_cast<TaskIndex>(i);
    if (robot_of(task) == self_) own_tasks_.push_back(task);
    if (concerns(task)) concern_.push_back(task);
  }
}

const HeldResult* Run::current(TaskIndex task) const {
  const HeldResult* held = results_.of(task);
  if (held == nullptr || is_final(held->result.outcome)) return held;
  // Who was replaced and did not know may have tried on: that says nothing of the robot that has the task now.
  const bool is_old = held->result.robot != robot_of(task) || is_void(task, held->result.key.attempt);
  return is_old || tries_again(task, held->result) ? nullptr : held;
}

bool Run::tries_again(TaskIndex task, const TaskResult& result) const {
  return result.outcome == TaskOutcome::retriable && result.key.attempt >= first_attempt_[task] &&
         result.key.attempt < kMaxAttempts && result.key.attempt - first_attempt_[task] < tasks()[task].retries;
}

Duration Run::retry_pause(TaskIndex task) const {
  constexpr double kLongest_s = 60;
  double pause_s = tasks()[task].retry_after_s;
  for (std::uint32_t i = first_attempt_[task] + 1; i < next_attempt(task); ++i)
    pause_s = std::min(pause_s * 2, kLongest_s);
  return seconds(std::clamp(pause_s, 0.0, 3600.0));
}

std::uint32_t Run::next_attempt(TaskIndex task) const {
  const HeldResult* held = results_.of(task);
  return held == nullptr ? first_attempt_[task] : std::max(first_attempt_[task], held->result.key.attempt + 1);
}

bool Run::begun(TaskIndex task) const {
  const auto start = starts_.find(task);
  return start != starts_.end() && start->second.key.attempt >= next_attempt(task);
}

Result<std::string> Run::data_for(TaskIndex task) const {
  return fill_values(tasks()[task], [this](const std::string& name) -> const TaskResult* {
    const auto before = index_of(name);
    return before && results_.has_final(*before) ? &results_.of(*before)->result : nullptr;
  });
}

std::vector<TaskIndex> Run::releasable() const {
  std::vector<TaskIndex> out;
  for (const TaskIndex task : asked_back) {
    if (robot_of(task) == self_ && !begun(task) && current(task) == nullptr) out.push_back(task);
  }
  return out;
}

/// Which batons this node owes by the facts that it holds: for a new epoch, in which the old ones mean nothing.
bool Run::gives(TaskIndex task) const {
  const auto& after = tasks()[task].after;
  if (after.empty()) return submitted_here_ || (self_ == decider_ && is_ruled(task));
  if (chooses_here(task)) return choice_on(task) != nullptr || all_before_skipped(task);
  const bool own = std::any_of(after.begin(), after.end(), [&](TaskIndex before) { return robot_of(before) == self_; });
  return (own && own_predecessors_final(task)) || decider_gives(task);
}

/// The decider passes on what its decision has given to another robot, and what a robot has finished that was replaced
/// since (that one is no actor any more) or that a person has said stands: it may never pass it on.
bool Run::decider_gives(TaskIndex task) const {
  if (self_ != decider_ || !all_before_final(task)) return false;
  const auto& after = tasks()[task].after;
  return is_ruled(task) || std::any_of(after.begin(), after.end(), [&](TaskIndex before) {
           const std::string& by = results_.of(before)->result.robot;
           return by != robot_of(before) || standing_.contains(by);
         });
}

/// Tasks that nobody is known to have passed on, though the decider, this node, holds every result before them.
std::vector<TaskIndex> Run::unpassed() const {
  std::vector<TaskIndex> out;
  if (self_ != decider_ || aborted() || ended() || held()) return out;
  for (std::size_t i = 0; i < tasks().size(); ++i) {
    const auto task = static_cast<TaskIndex>(i);
    const bool is_open = results_.of(task) == nullptr && !tasks()[task].after.empty() && next_hand(task) != self_;
    if (is_open && !has_passed(task) && all_before_final(task)) out.push_back(task);
  }
  return out;
}

void Run::pass_instead(TaskIndex task) {
  if (!progress.contains(task) && !has_passed(task)) owe_batons({task});
}

bool Run::has_passed(TaskIndex task) const {
  const auto passed = passed_.find({task, next_hand(task)});
  return passed != passed_.end() && passed->second >= since_[task];
}

bool Run::is_of_epoch(const std::vector<TaskIndex>& tasks, std::uint32_t epoch) const {
  return std::all_of(tasks.begin(), tasks.end(),
                     [&](TaskIndex task) { return task < since_.size() && since_[task] <= epoch; });
}

void Run::owe_batons_anew() {
  deliveries.drop_batons();
  std::vector<TaskIndex> open;
  for (std::size_t i = 0; i < tasks().size(); ++i) {
    const auto task = static_cast<TaskIndex>(i);
    if (!results_.has_final(task) && !has_passed(task) && gives(task)) open.push_back(task);
  }
  owe_batons(open);
}

}  // namespace trb::scheduler
