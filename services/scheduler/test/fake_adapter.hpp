// A mode-adapter for tests: every skill takes the same time and succeeds, unless a test says otherwise. It answers as
// the real one does: tests/contract/fake_adapter_test.cpp compares the two.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/actor/inbound.hpp"
#include "common/base/time.hpp"

namespace trb::scheduler::test {

class FakeAdapter {
 public:
  struct Said {
    std::uint64_t reply_to = 0;
    Body body;
  };

  void hear(const Inbound& message, MonotonicTime now);
  void tick(MonotonicTime now);
  [[nodiscard]] std::optional<MonotonicTime> next() const;
  /// What it has to say since the last call, in order.
  std::vector<Said> take();

  /// A new process: it knows nothing of what it was doing. The attempts of which nobody else knows how they ended.
  std::vector<AttemptKey> restart();
  /// Ends what runs, unless the robot stays there and is not stopped.
  void set(bool online, bool is_fenced);
  [[nodiscard]] bool is_fenced() const { return fenced_; }
  void take_into_use(const TakeIntoUse& word);
  /// Nothing is kept of that run any more.
  void forget(const std::string& run);
  void set_out_of_use(std::vector<OutOfUse> what);
  /// Another has the control lease; empty: nobody.
  void set_control(const std::string& holder);

  std::uint64_t instance = 100;
  std::vector<SkillUse> skills;
  std::vector<OutOfUse> out_of_use;
  Duration skill_time = seconds(1);
  TaskOutcome ending = TaskOutcome::finished;
  bool tells_free = true;                      ///< its state follows an outcome
  int asked_state = 0;                         ///< how often
  std::map<std::string, TaskOutcome> endings;  ///< of some tasks, by id
  /// In place of both: how an attempt ends, and the result that the robot tells.
  std::function<std::pair<TaskOutcome, std::string>(const Execute&)> world;
  std::vector<std::string> halted;          ///< skills that an earlier process may have begun
  std::map<AttemptKey, std::string> given;  ///< the data of every attempt that was begun
  /// How often each attempt was begun, by instance; and how often it was commanded.
  std::map<std::pair<std::uint64_t, AttemptKey>, int> begun;
  std::map<std::pair<std::uint64_t, AttemptKey>, int> commanded;

 private:
  void execute(const Execute& execute, const Inbound& message, MonotonicTime now);
  void cancel(const Inbound& message, const AttemptKey& key, MonotonicTime now);
  void query(const Inbound& message, const AttemptKey& key);
  /// The attempt runs or has ended, and that is the answer.
  bool answer_known(const Inbound& message, const AttemptKey& key);
  [[nodiscard]] std::optional<Errc> refusal(const Execute& execute) const;
  void keep(const Outcome& outcome, MonotonicTime now);
  void end(TaskOutcome outcome, const std::string& reason, MonotonicTime now,
           const std::string& result = R"({"done":true})");
  void end_by_itself(MonotonicTime now);
  void tell_state(std::uint64_t reply_to = 0);
  void refuse(const Inbound& message, Errc code);
  [[nodiscard]] bool is_out_of_use(const std::string& skill) const;

  struct Running {
    AttemptKey key;
    MonotonicTime until;
    Execute execute;
  };
  bool online_ = true;
  bool fenced_ = false;
  bool changed_ = false;  ///< one of these two, untold
  std::string control_;
  std::optional<Running> running_;
  struct Kept {
    Outcome outcome;
    bool journaled = false;
  };
  std::map<AttemptKey, Kept> outcomes_;
  std::optional<MonotonicTime> resend_;
  std::vector<Said> said_;
};

}  // namespace trb::scheduler::test
