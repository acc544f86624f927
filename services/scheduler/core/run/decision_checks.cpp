#include "services/scheduler/core/run/decision_checks.hpp"

#include <algorithm>
#include <set>

#include "common/security/keys.hpp"
#include "proto/body.hpp"
#include "proto/message.hpp"

namespace trb::scheduler {
namespace {

constexpr std::size_t kRecordOverhead = 256;
constexpr std::size_t kDefinitionOverhead = 4096;

}  // namespace

Result<Decision> DecisionChecks::decision(const SignedRecord& record) const {
  if (auto checked = check_author(record); !checked) return checked.error();
  auto decision = open_record<Decision>(record, kSignedDecision, *members_.find(record.signer));
  if (!decision) return decision.error();
  if (decision->by != record.signer) return fail(Errc::source_mismatch, name() + "it names another node");
  if (auto checked = check_place(*decision); !checked) return checked.error();
  if (auto checked = check_size(record); !checked) return checked.error();
  if (decision->tasks.empty()) return fail(Errc::bad_value, name() + "on no task");
  if (auto added = members_.open_new(*decision, certificates_); !added) return added.error();
  if (auto checked = check_rulings(*decision); !checked) return checked.error();
  return decision;
}

Status DecisionChecks::check_author(const SignedRecord& record) const {
  const DecisionRule& rule = definition_.rule();
  if (rule.may_decide(record.signer)) return Done{};
  return fail(Errc::not_permitted, name() + "'" + record.signer + "' is not its decider" +
                                       (rule.decider().empty() ? "; it has none" : ", '" + rule.decider() + "' is"));
}

/// Of this run, and built on the epoch that counts.
Status DecisionChecks::check_place(const Decision& decision) const {
  if (decision.run != definition_.id() || decision.digest != definition_.start().digest) {
    return fail(Errc::conflict, name() + "of another run");
  }
  if (decision.epoch != epochs_.current() + 1) {
    return fail(Errc::conflict, name() + "epoch " + std::to_string(decision.epoch) + " does not follow epoch " +
                                    std::to_string(epochs_.current()));
  }
  const Bytes before = epochs_.records().empty() ? Bytes{} : digest(epochs_.records().back().payload.bytes);
  if (decision.previous.bytes != before) return fail(Errc::conflict, name() + "it is not built on the one before");
  return Done{};
}

/// A member that comes late gets all of it in one message.
Status DecisionChecks::check_size(const SignedRecord& record) const {
  if (epochs_.decisions().size() >= kMaxDecisions) {
    return fail(Errc::too_large, name() + "there are 64 already", "abort the run");
  }
  std::size_t size = definition_.record().payload.bytes.size() + record.payload.bytes.size();
  for (const SignedRecord& one : epochs_.records()) size += one.payload.bytes.size() + kRecordOverhead;
  if (size <= kMaxDataSize - kDefinitionOverhead) return Done{};
  return fail(Errc::too_large, name() + "with the ones before it has no place in a message", "abort the run");
}

Status DecisionChecks::check_rulings(const Decision& decision) const {
  std::set<std::string> seen;
  for (const TaskRuling& ruling : decision.tasks) {
    if (!seen.insert(ruling.task).second) return fail(Errc::duplicate, name_of_task(ruling) + " occurs twice");
    if (auto checked = check_ruling(decision, ruling); !checked) return checked;
  }
  return Done{};
}

Status DecisionChecks::check_ruling(const Decision& decision, const TaskRuling& ruling) const {
  const auto task = definition_.index_of(ruling.task);
  if (!task) return fail(Errc::bad_value, name_of_task(ruling) + ": no such task");
  if (auto checked = check_attempt(*task, ruling); !checked) return checked;
  const bool added =
      std::ranges::any_of(decision.members, [&](const Member& member) { return member.id == ruling.robot; });
  return check_robot(*task, ruling, added || members_.is_robot(ruling.robot));
}

Status DecisionChecks::check_attempt(TaskIndex task, const TaskRuling& ruling) const {
  // Where all attempts are used up it can still be skipped.
  const std::uint32_t most = kMaxAttempts + (ruling.ruling == Ruling::skip ? 1 : 0);
  const std::uint32_t first = epochs_.first_attempt(task);
  if (ruling.attempt > first && ruling.attempt <= most) return Done{};
  return fail(Errc::bad_value,
              name_of_task(ruling) + ": attempt " + std::to_string(ruling.attempt) + " is not one of " +
                  std::to_string(first + 1) + " to " + std::to_string(most),
              "skip it, or abort the run");
}

Status DecisionChecks::check_robot(TaskIndex task, const TaskRuling& ruling, bool is_robot) const {
  const std::string about = name_of_task(ruling) + ": ";
  const std::string& now = epochs_.robot_of(task);
  const bool stays = ruling.robot == now;
  switch (ruling.ruling) {
    case Ruling::move:
      if (!is_robot || stays)
        return fail(Errc::bad_value, about + "'" + ruling.robot + "' is no other robot of the run");
      if (definition_.tasks()[task].pinned && !epochs_.is_unbound(task))
        return fail(Errc::not_permitted, about + "it is pinned to '" + now + "'");
      break;
    case Ruling::retry:
      if (!is_robot || !stays) return fail(Errc::bad_value, about + "'" + ruling.robot + "' is not its robot");
      break;
    case Ruling::skip:
      if (!definition_.rule().may_decide(ruling.robot))
        return fail(Errc::bad_value, about + "what is skipped goes to the decider's node");
      break;
  }
  return Done{};
}

Status DecisionChecks::grounds(const Decision& decision, const Facts& facts) const {
  for (const TaskRuling& ruling : decision.tasks) {
    if (auto checked = check_ground(ruling, facts); !checked) return checked;
  }
  return Done{};
}

Status DecisionChecks::check_ground(const TaskRuling& ruling, const Facts& facts) const {
  const TaskIndex task = *definition_.index_of(ruling.task);
  const std::string about = name_of_task(ruling) + " ";
  const HeldResult* held = facts.current(task);
  if (facts.results().has_final(task)) {
    return fail(Errc::conflict, about + "is " + std::string(name_of(held->result.outcome)) + " already",
                "look at the run, decide anew");
  }
  if (held != nullptr && definition_.ends_run(task, held->result)) {
    return fail(Errc::conflict, about + "has failed, and that ends the run");
  }
  if (ruling.evidence == Evidence::result && held == nullptr) {
    return fail(Errc::conflict, about + "has not been given up by '" + epochs_.robot_of(task) + "'",
                "ask it back, or give your word that the robot stands");
  }
  // Who is silent may have tried again as often as the task says.
  const std::uint32_t tried = epochs_.first_attempt(task) + definition_.tasks()[task].retries;
  const std::uint32_t next = ruling.evidence == Evidence::word ? tried + 1 : facts.next_attempt(task);
  if (ruling.attempt >= next) return Done{};
  return fail(Errc::conflict, about + "may have come to attempt " + std::to_string(next - 1),
              "number it " + std::to_string(next));
}

}  // namespace trb::scheduler
