// A run that the fuzzer knows completely, with all keys; and what a scheduler's journal proves of it, by an independent
// implementation of the rules of a run.
#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/scenario/condition.hpp"
#include "common/scenario/run_start.hpp"
#include "common/scenario/test/make_task.hpp"
#include "common/security/keys.hpp"
#include "proto/body.hpp"
#include "services/scheduler/core/journal_records.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {

constexpr std::int64_t kEpoch = 1'800'000'000'000'000'000;
const std::string kRun(32, 'a');
const char* const kNodes[] = {"cloud", "b", "c", "d", "a", "stranger"};
constexpr std::size_t kTasks = 8;

inline Task task(const char* id, const char* robot, std::vector<std::uint16_t> after) {
  return make_task(id, robot, "do", std::move(after));
}

inline Scenario scenario() {
  Scenario out;
  out.tasks = {task("bring", "b", {}),       task("left", "a", {0}), task("right", "a", {0}), task("carry", "c", {0}),
               task("join", "a", {1, 2, 3}), task("own", "a", {}),   task("end", "b", {4}),   task("late", "", {5})};
  out.tasks[1].when = {{"temperature", "b", "", Comparison::at_most, false, 20, "", "degC"}};
  out.tasks[2].when = {{"temperature", "b", "", Comparison::more, false, 20, "", "degC"}};
  out.tasks[4].values = {{"from", "carry", ""}};
  out.tasks[5].retries = 2;
  out.tasks[5].on_failure = OnFailure::skip;
  out.tasks[7].requires_ = {"hands"};
  return out;
}

/// All keys, made once. "d" is of the fleet but no member of the run; the stranger is of another fleet.
struct Keys {
  SigningKey authority_key = make_signing_key();
  FleetAuthority authority{"hall", authority_key.public_key};
  std::map<std::string, SigningKey> keys;
  std::map<std::string, SignedRecord> certificates;
  std::map<std::string, Certificate> opened;
  SignedRecord start;
  Blob digest;

  Keys() {
    for (const std::string node : kNodes) {
      keys[node] = make_signing_key();
      Certificate certificate;
      certificate.fleet.bytes = authority.id();
      certificate.id = node;
      certificate.role = node == "cloud" ? Role::cloud : Role::robot;
      certificate.identity_key.bytes = keys[node].public_key;
      certificate.link_key.bytes = Bytes(32, 'l');
      opened[node] = certificate;
      certificates[node] = trb::sign(kSignedCertificate, "", authority.id(), encode(certificate),
                                     node == "stranger" ? make_signing_key() : authority_key);
    }
    std::vector<Member> members;
    for (const char* node : {"cloud", "a", "b", "c"}) members.push_back({node, certificates[node]});
    const RunStart run = build_run_start(scenario(), members, "cloud", {kEpoch}, {kEpoch + 3'600'000'000'000}, kRun,
                                         {"b", "a", "a", "c", "a", "a", "b", "cloud"});
    digest = run.digest;
    start = sign("cloud", kSignedRunStart, encode(run));
  }
  [[nodiscard]] SignedRecord sign(const std::string& who, std::string_view purpose, Bytes payload) const {
    const auto key = keys.find(who);
    return trb::sign(purpose, who, authority.id(), std::move(payload),
                     (key == keys.end() ? *keys.begin() : *key).second);
  }
  static const Keys& get() {
    init_crypto();
    static const Keys all;
    return all;
  }
};

/// What the journal proves.
class Proof {
 public:
  void take(const scheduler::JournalRecord& record) {
    std::visit(
        Overloaded{[&](const scheduler::JournalRun& is) { open(is.start); },
                   [&](const scheduler::JournalResult& is) { result(is.result); },
                   [&](const scheduler::JournalChoice& is) { choice(is.choice); },
                   [&](const scheduler::JournalDecision& is) { decision(is.decision); },
                   [&](const scheduler::JournalStart& is) { start(is); },
                   [&](const scheduler::JournalPause& is) { pause(is.order); },
                   [&](const scheduler::JournalAbort& is) { abort(is.order); },
                   [](const scheduler::JournalDelivered&) {}, [&](const scheduler::JournalEnd& is) { end(is.end); },
                   [](const scheduler::JournalArchive&) {}, [](const scheduler::JournalTime&) {},
                   [](const auto&) { require(false, "only facts are journaled"); }},
        record);
  }
  void command(const Execute& execute) const {
    require(started_.contains(execute.key), "a start record comes before the command");
  }
  [[nodiscard]] std::uint32_t epoch() const { return static_cast<std::uint32_t>(decisions_.size()) + 1; }
  [[nodiscard]] Bytes last_decision() const { return last_; }
  [[nodiscard]] std::string robot_in(std::size_t index, std::uint32_t epoch) const {
    std::string out = tasks_[index].robot.empty() ? "cloud" : tasks_[index].robot;
    for (const Decision& decision : decisions_) {
      if (decision.epoch > epoch) break;
      for (const TaskRuling& ruling : decision.tasks) {
        if (ruling.task == tasks_[index].id) out = ruling.robot;
      }
    }
    return out;
  }

 private:
  struct Said {
    TaskResult result;
    std::size_t task = 0;
  };

  template <class T>
  T opened(const SignedRecord& record, std::string_view purpose) const {
    require(members_.contains(record.signer), "only members' words are journaled");
    auto out = open_record<T>(record, purpose, Keys::get().opened.at(record.signer));
    require(out.ok(), "only what is well signed is journaled");
    return std::move(*out);
  }
  [[nodiscard]] std::size_t index_of(const std::string& id) const {
    const auto at = std::find_if(tasks_.begin(), tasks_.end(), [&](const Task& one) { return one.id == id; });
    require(at != tasks_.end(), "only tasks of the run");
    return static_cast<std::size_t>(at - tasks_.begin());
  }

  void open(const SignedRecord& record) {
    require(record.payload == Keys::get().start.payload, "only what the submitter has signed is a run");
  }
  void result(const SignedRecord& record) {
    const auto is = opened<TaskResult>(record, kSignedResult);
    const std::size_t index = index_of(is.key.task);
    require(is.key.run == kRun && is.digest == Keys::get().digest, "only results of this run");
    require(
        is.epoch >= 1 && is.epoch <= epoch() && robot_in(index, is.epoch) == record.signer && is.robot == record.signer,
        "a result is its robot's, in its epoch");
    const bool gives_up = is.outcome == TaskOutcome::released && is.key.attempt == 1;
    require(record.signer != "cloud" || is.outcome == TaskOutcome::skipped || gives_up, "a cloud node does nothing");
    results_.push_back({is, index});
  }
  void choice(const SignedRecord& record) {
    const auto is = opened<Choice>(record, kSignedChoice);
    for (const ChosenTask& chosen : is.tasks) {
      const Task& of = tasks_[index_of(chosen.task)];
      require(!of.when.empty() && holds(of.when[0], is.reading) == chosen.holds, "a verdict is its reading's");
      verdicts_.try_emplace(chosen.task, chosen.holds);  // the first one counts
    }
  }
  void decision(const SignedRecord& record) {
    require(record.signer == "cloud", "only the decider decides");
    const auto is = opened<Decision>(record, kSignedDecision);
    require(is.epoch == epoch() + 1 && is.previous.bytes == last_, "there is one chain of epochs");
    decisions_.push_back(is);
    last_ = trb::digest(record.payload.bytes);
    for (const Member& member : is.members) members_.insert(member.id);
  }
  void pause(const SignedRecord& record) { held_ = opened<PauseOrder>(record, kSignedRunPause).paused; }
  void abort(const SignedRecord& record) {
    require(opened<AbortOrder>(record, kSignedRunAbort).run == kRun, "an abort is for its run");
    aborted_ = true;
  }

  void end(const SignedRecord& record) {
    require(record.signer == "cloud", "only who holds every result says that all is done");
    require(opened<RunEnd>(record, kSignedRunEnd).state == RunState::finished, "the end is FINISHED");
    ended_ = true;
  }

  [[nodiscard]] bool is_final(std::size_t index) const {
    return std::any_of(results_.begin(), results_.end(), [&](const Said& said) {
      return said.task == index &&
             (said.result.outcome == TaskOutcome::finished || said.result.outcome == TaskOutcome::skipped);
    });
  }
  /// May another attempt follow the previous one: by its robot's result, or a decision?
  [[nodiscard]] bool may_follow(std::size_t index, std::uint32_t attempt) const {
    if (attempt == 1) return true;
    const auto retriable = [&](const Said& said) {
      const TaskOutcome how = said.result.outcome;
      return said.task == index && said.result.key.attempt + 1 == attempt &&
             (how == TaskOutcome::retriable || how == TaskOutcome::released);
    };
    const auto ruled = [&](const Decision& decision) {
      return std::any_of(decision.tasks.begin(), decision.tasks.end(), [&](const TaskRuling& ruling) {
        return ruling.task == tasks_[index].id && ruling.attempt <= attempt;
      });
    };
    return std::any_of(results_.begin(), results_.end(), retriable) ||
           std::any_of(decisions_.begin(), decisions_.end(), ruled);
  }
  void start(const scheduler::JournalStart& is) {
    const std::size_t index = index_of(is.key.task);
    const Task& of = tasks_[index];
    require(is.key.run == kRun && robot_in(index, epoch()) == "a", "it starts what is its own");
    require(is.epoch == epoch(), "it starts in this epoch");
    require(started_.insert(is.key).second, "no attempt is started twice");
    require(!aborted_ && !held_ && !ended_, "nothing starts in a run that is aborted, held or over");
    require(!is_final(index), "what is final is not done again");
    for (const std::uint16_t before : of.after) require(is_final(before), "all before it is final");
    require(of.when.empty() || (verdicts_.contains(of.id) && verdicts_.at(of.id)), "its condition holds");
    require(may_follow(index, is.key.attempt), "the attempt before is over by its robot's word or a decision");
  }

  const std::vector<Task> tasks_ = scenario().tasks;
  std::set<std::string> members_{"cloud", "a", "b", "c"};
  std::vector<Decision> decisions_;
  Bytes last_;
  std::vector<Said> results_;
  std::map<std::string, bool> verdicts_;
  std::set<AttemptKey> started_;
  bool aborted_ = false;
  bool held_ = false;
  bool ended_ = false;
};

}  // namespace trb::fuzz
