#include "common/scenario/run_proof.hpp"

#include <array>
#include <map>
#include <set>

#include "common/scenario/condition.hpp"
#include "common/scenario/decision_rule.hpp"
#include "common/scenario/graph.hpp"
#include "common/scenario/run_start.hpp"
#include "proto/body.hpp"

namespace trb {
namespace {

struct Kind {
  std::string_view purpose;
  std::string_view subtype;  ///< of the payload
};
constexpr std::array kKinds{Kind{kSignedRunStart, RunStart::kSubtype},   Kind{kSignedDecision, Decision::kSubtype},
                            Kind{kSignedRunPause, PauseOrder::kSubtype}, Kind{kSignedRunAbort, AbortOrder::kSubtype},
                            Kind{kSignedChoice, Choice::kSubtype},       Kind{kSignedResult, TaskResult::kSubtype},
                            Kind{kSignedRunEnd, RunEnd::kSubtype}};

std::string because(const std::string& reason) {
  return reason.empty() ? "" : ": " + reason;
}

std::string words_of(const RunStart& start) {
  return "run '" + start.scenario.name + "' of " + std::to_string(start.scenario.tasks.size()) + " tasks";
}

std::string words_of(const Decision& decision) {
  std::string out = "epoch " + std::to_string(decision.epoch) + ", decided by " +
                    (decision.person.empty() ? "the policy" : decision.person) + because(decision.reason);
  for (const TaskRuling& ruling : decision.tasks) {
    out += "; " + ruling.task + ": " + std::string(name_of(ruling.ruling)) + " -> " + ruling.robot;
  }
  return out;
}

std::string words_of(const PauseOrder& order) {
  return (order.paused ? "holds the run" : "lets the run go on") + because(order.reason);
}

std::string words_of(const Choice& choice) {
  std::string out = choice.reading.sensor + " of " + choice.node + " decides";
  for (const ChosenTask& task : choice.tasks) out += "; " + task.task + ": " + (task.holds ? "yes" : "no");
  return out;
}

std::string words_of(const TaskResult& result) {
  return result.key.task + ": " + std::string(name_of(result.outcome)) + ", attempt " +
         std::to_string(result.key.attempt) + because(result.reason);
}

bool is_final(TaskOutcome outcome) {
  return outcome == TaskOutcome::finished || outcome == TaskOutcome::skipped;
}

class Checker {
 public:
  explicit Checker(const FleetAuthority& authority) : authority_(authority) {}

  RunProof check(std::span<const SignedRecord> records) {
    for (std::size_t i = 0; i < records.size(); ++i) {
      auto taken = take(records[i]);
      if (taken) {
        proof_.records.push_back(std::move(*taken));
      } else {
        proof_.faults.push_back("record " + std::to_string(i + 1) + ", " + records[i].kind + " of '" +
                                records[i].signer + "': " + taken.error().text());
      }
      if (proof_.run.empty()) break;  // nothing can be checked without the start
    }
    if (records.empty()) proof_.faults.emplace_back("no record");
    proof_.final_tasks = final_.size();
    return std::move(proof_);
  }

 private:
  using Proven = Result<ProvenRecord>;

  Proven take(const SignedRecord& record) {
    if (proof_.run.empty()) return take_start(record);
    if (record.kind == kSignedDecision) return take_decision(record);
    if (record.kind == kSignedRunPause) return take_order<PauseOrder>(record, [](auto& o) { return words_of(o); });
    if (record.kind == kSignedRunAbort) {
      return take_order<AbortOrder>(record, [](auto& order) { return "aborts the run" + because(order.reason); });
    }
    if (record.kind == kSignedChoice) return take_choice(record);
    if (record.kind == kSignedResult) return take_result(record);
    if (record.kind == kSignedRunEnd) return take_end(record);
    return fail(Errc::bad_value, "no record of a run, or a second start");
  }

  using Members = std::map<std::string, Certificate>;

  /// The members together with these, none of them twice.
  Result<Members> with(const std::vector<Member>& members) const {
    Members out = members_;
    for (const Member& member : members) {
      auto certificate = open_certificate_any_time(member.certificate, authority_);
      if (!certificate) return certificate.error();
      if (certificate->id != member.id) return fail(Errc::source_mismatch, "member '" + member.id + "' is another");
      if (!out.emplace(member.id, std::move(*certificate)).second) {
        return fail(Errc::duplicate, "member '" + member.id + "' occurs twice");
      }
    }
    return out;
  }

  Proven take_start(const SignedRecord& record) {
    auto start = decode<RunStart>(record.payload.bytes);
    if (!start) return start.error();
    if (auto checked = check_run_start(*start); !checked) return checked.error();
    auto members = with(start->members);
    if (!members) return members.error();
    members_ = std::move(*members);
    if (auto opened = open<RunStart>(record, kSignedRunStart); !opened) return opened.error();
    if (start->submitter != record.signer) return fail(Errc::source_mismatch, "its submitter is another");
    start_ = std::move(*start);
    rule_ = DecisionRule(start_);
    robots_ = {start_.first.robots};
    for (std::size_t i = 0; i < start_.scenario.tasks.size(); ++i) tasks_.emplace(start_.scenario.tasks[i].id, i);
    proof_.run = start_.run;
    proof_.tasks = tasks_.size();
    return ProvenRecord{record.kind, record.signer, {start_.created}, words_of(start_)};
  }

  /// Signed by a member for this run.
  template <class T>
  Result<T> open(const SignedRecord& record, std::string_view purpose) {
    const auto signer = members_.find(record.signer);
    if (signer == members_.end()) return fail(Errc::not_permitted, "its signer is no member");
    return open_record<T>(record, purpose, signer->second);
  }

  template <class T>
  Result<T> open_own(const SignedRecord& record, std::string_view purpose) {
    auto body = open<T>(record, purpose);
    if (!body) return body;
    if (body->by != record.signer) return fail(Errc::source_mismatch, "it names '" + body->by + "' as its signer");
    if (body->run != start_.run) return fail(Errc::conflict, "it is of another run");
    return body;
  }

  Proven take_decision(const SignedRecord& record) {
    const auto decision = open_own<Decision>(record, kSignedDecision);
    if (!decision) return decision.error();
    if (!rule_.may_decide(record.signer)) return fail(Errc::not_permitted, "it is not the decider");
    const bool follows = decision->digest == start_.digest && decision->epoch == robots_.size() + 1 &&
                         decision->previous.bytes == last_decision_;
    if (!follows) return fail(Errc::conflict, "it does not follow the decision before");
    auto members = with(decision->members);
    if (!members) return members.error();
    auto robots = robots_.back();
    for (const TaskRuling& ruling : decision->tasks) {
      const auto task = tasks_.find(ruling.task);
      const auto robot = members->find(ruling.robot);
      // What is skipped goes to the decider, all else to a robot.
      const bool fits =
          task != tasks_.end() && robot != members->end() &&
          (ruling.ruling == Ruling::skip ? rule_.may_decide(ruling.robot) : robot->second.role == Role::robot);
      if (!fits) return fail(Errc::bad_value, "ruling on '" + ruling.task + "': no such task or robot");
      robots[task->second] = ruling.robot;
    }
    members_ = std::move(*members);
    robots_.push_back(std::move(robots));
    last_decision_ = digest(record.payload.bytes);
    return ProvenRecord{record.kind, record.signer, {decision->time}, words_of(*decision)};
  }

  template <class Order, class Words>
  Proven take_order(const SignedRecord& record, const Words& words) {
    const auto order = open_own<Order>(record, record.kind);
    if (!order) return order.error();
    return ProvenRecord{record.kind, record.signer, {order->time}, words(*order)};
  }

  Status check_epoch(const Blob& digest_of_start, std::uint32_t epoch) const {
    if (digest_of_start == start_.digest && epoch >= 1 && epoch <= robots_.size()) return Done{};
    return fail(Errc::conflict, "it is of another run, or of an epoch without its decision");
  }

  Proven take_choice(const SignedRecord& record) {
    const auto choice = open_own<Choice>(record, kSignedChoice);
    if (!choice) return choice.error();
    if (auto checked = check_epoch(choice->digest, choice->epoch); !checked) return checked.error();
    for (const ChosenTask& chosen : choice->tasks) {
      const auto task = tasks_.find(chosen.task);
      const bool theirs =
          task != tasks_.end() &&
          robots_[choice->epoch - 1][chooser_of(start_.scenario, static_cast<TaskIndex>(task->second))] == choice->by;
      if (!theirs) return fail(Errc::not_permitted, "the choice on task '" + chosen.task + "' is another's");
      const std::vector<Condition>& when = start_.scenario.tasks[task->second].when;
      if (when.empty() || !believe(when.front(), choice->reading) ||
          holds(when.front(), choice->reading) != chosen.holds) {
        return fail(Errc::bad_value, "the choice on task '" + chosen.task + "': its own reading says otherwise");
      }
    }
    return ProvenRecord{record.kind, record.signer, {choice->time}, words_of(*choice)};
  }

  Proven take_result(const SignedRecord& record) {
    const auto result = open<TaskResult>(record, kSignedResult);
    if (!result) return result.error();
    if (result->key.run != start_.run) return fail(Errc::conflict, "it is of another run");
    if (auto checked = check_epoch(result->digest, result->epoch); !checked) return checked.error();
    const auto task = tasks_.find(result->key.task);
    const bool theirs = task != tasks_.end() && result->robot == record.signer &&
                        robots_[result->epoch - 1][task->second] == record.signer;
    if (!theirs) return fail(Errc::not_permitted, "task '" + result->key.task + "' was not its own");
    const bool is_cloud = members_.at(record.signer).role == Role::cloud;
    if (is_cloud && result->outcome != TaskOutcome::skipped && result->outcome != TaskOutcome::released) {
      return fail(Errc::not_permitted, "a cloud node does no task: it can skip '" + result->key.task + "'");
    }
    if (is_final(result->outcome)) final_.insert(task->second);
    return ProvenRecord{record.kind, record.signer, {result->ended}, words_of(*result)};
  }

  Proven take_end(const SignedRecord& record) {
    const auto end = open_own<RunEnd>(record, kSignedRunEnd);
    if (!end) return end.error();
    if (record.signer != rule_.judge()) return fail(Errc::not_permitted, "'" + rule_.judge() + "' says it, no other");
    if (end->state != RunState::finished) return fail(Errc::bad_value, "only FINISHED is said so");
    if (end->digest != start_.digest) return fail(Errc::conflict, "it is of another run");
    proof_.has_ended = true;
    return ProvenRecord{record.kind, record.signer, {end->time}, std::string(name_of(end->state))};
  }

  const FleetAuthority& authority_;
  RunProof proof_;
  RunStart start_;
  DecisionRule rule_;
  Members members_;
  std::map<std::string, std::size_t> tasks_;      ///< id -> place
  std::vector<std::vector<std::string>> robots_;  ///< of each task, by epoch
  Bytes last_decision_;                           ///< the digest of its payload
  std::set<std::size_t> final_;
};

}  // namespace

RunProof check_run_proof(std::span<const SignedRecord> records, const FleetAuthority& authority) {
  return Checker(authority).check(records);
}

Result<std::string> content_of(const SignedRecord& record) {
  for (const Kind& kind : kKinds) {
    if (kind.purpose == record.kind) return body_to_json(kind.subtype, record.payload.bytes);
  }
  return fail(Errc::bad_value, "'" + record.kind + "' is no record of a run");
}

}  // namespace trb
