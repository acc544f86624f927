// The robot side: one attempt at a time, from its start record to its signed result.
#pragma once

#include <optional>
#include <string>

#include "common/actor/outbox.hpp"
#include "common/base/time.hpp"
#include "services/scheduler/core/permit.hpp"

namespace trb::scheduler {

/// `commanded`: Execute is out and unanswered. `refused`: the mode-adapter would not begin, for now. `signing`: it has
/// ended, the router is requested to sign the result.
enum class Phase : std::uint8_t { commanded = 0, running, refused, signing };

struct Attempt {
  Execute execute;
  TaskResult result;          ///< filled in to the end that is known so far
  bool may_retry = false;     ///< the robot has tries left
  OnFailure on_failure{};     ///< once it has none
  std::size_t most_data = 0;  ///< of its result: more is left out
  Phase phase{};
  Permit permit{};
  MonotonicTime next{};  ///< of the question or resend that the phase asks for
  MonotonicTime next_cancel{};
  Bytes payload;          ///< signing: what the router is to sign
  std::string why;        ///< of the permit
  std::string sent_wait;  ///< refused: what it waits for, as last sent
  MonotonicTime next_sent{};
};

class Executor {
 public:
  explicit Executor(std::string node) : node_(std::move(node)) {}

  [[nodiscard]] const std::optional<Attempt>& attempt() const { return attempt_; }
  [[nodiscard]] bool runs(const std::string& run) const { return attempt_ && attempt_->execute.key.run == run; }
  [[nodiscard]] const std::optional<AdapterState>& adapter() const { return adapter_; }
  /// Why that skill cannot begin now, for a person; empty: it can.
  [[nodiscard]] std::string obstacle(const std::string& skill) const;
  /// Its own attempt's, which the mode-adapter has refused.
  [[nodiscard]] std::string obstacle() const;
  /// Its attempt was commanded, and has not begun.
  [[nodiscard]] bool is_refused() const { return attempt_ && attempt_->phase == Phase::refused; }

  /// The service has come (back) to its router: nothing is known of the mode-adapter, everything is asked again.
  void welcome(Now now, Outbox& out);
  /// Begins an attempt whose start record is journaled in the same step.
  void begin(Attempt attempt, Now now, Outbox& out);
  /// Takes up an attempt whose start record was found: it may or may not have been commanded.
  void resume(Attempt attempt);
  void allow(Permit permit, const std::string& why);
  /// A task waits for the mode-adapter: ask for its state now and then.
  void want_adapter(bool wanted) { wanted_ = wanted; }

  void on(const AdapterState& state, Now now, Outbox& out);
  void on(const ExecutionState& state, Now now, Outbox& out);
  void on(const Outcome& outcome, Now now, Outbox& out);
  void on_refusal(const Nack& nack, Now now, Outbox& out);
  /// The signed result is journaled in the same step, or the attempt is given up.
  void done(Outbox& out);

  /// What its refused attempt waits for, at each change and every 10 s; empty: there is nothing to send.
  std::string take_wait(Now now);

  void tick(Now now, Outbox& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  void command(Now now, Outbox& out);
  void command_if_possible(Now now, Outbox& out);
  void query_state(Now now, Outbox& out);
  void end_unbegun(Now now, Outbox& out);
  void end(TaskOutcome outcome, const std::string& reason, Now now, Outbox& out);
  [[nodiscard]] bool is_to_stop() const;
  [[nodiscard]] const SkillUse* find_skill(const std::string& skill) const;
  void sign(Now now, Outbox& out);
  void interrupt_if_other(std::uint64_t instance, Now now, Outbox& out);

  std::string node_;
  std::optional<AdapterState> adapter_;
  std::optional<Attempt> attempt_;
  bool wanted_ = false;
  MonotonicTime next_state_request_{};
};

}  // namespace trb::scheduler
