// The scheduler's side: carries out one skill at a time; every attempt has one outcome.
#pragma once

#include "services/mode-adapter/core/outcomes.hpp"
#include "services/mode-adapter/core/robot_side.hpp"

namespace trb::adapter {

/// message          | unknown attempt                     | running            | ended
/// -----------------|-------------------------------------|--------------------|--------
/// Execute          | begins; Nack; or failed at once     | "running"          | its Outcome
/// CancelExecution  | failed, so that it never begins     | halted, failed     | its Outcome
/// ExecutionQuery   | "unknown"                           | "running"          | its Outcome
class SkillDesk {
 public:
  explicit SkillDesk(RobotSide& robot) : robot_(robot) {}

  /// `barred`: why nothing may begin, if so. True: the skill has begun.
  bool execute(const Inbound& message, const Execute& order, const std::optional<Error>& barred, Now now, Outbox& out);
  void cancel(const Inbound& message, const CancelExecution& order, Now now, Outbox& out);
  void query(const Inbound& message, const ExecutionQuery& query, Outbox& out);
  void journaled(const OutcomeJournaled& outcome) { outcomes_.acknowledge(outcome.key); }

  [[nodiscard]] bool busy() const { return running_.has_value(); }
  [[nodiscard]] bool owns(Token token) const { return running_ && running_->token == token; }

  /// The robot has received the command.
  void on_under_way(Now now);
  void on_ended(const Ended& ended, Now now, Outbox& out);
  void on_refused(const Error& error, Now now, Outbox& out);
  void on_values(const Driver* mode, Now now, Outbox& out);
  /// Information from the robot to its own node may be the state or position that ends a skill.
  void on_information(const Driver* mode, std::string_view subtype, BytesView data, Now now, Outbox& out);
  /// A fault that takes the running skill's capability away: if no other event would end the skill, it is halted and
  /// has failed.
  void on_fault(std::string_view capability, Severity severity, const std::string& text, Now now, Outbox& out);
  void on_link_down(const Driver* mode, const std::string& reason, Now now, Outbox& out);
  void interrupt(const std::string& reason, Now now, Outbox& out);

  void tick(Now now, Outbox& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  struct Running {
    AttemptKey key;
    const Skill* skill = nullptr;
    Token token = 0;
    Driver* mode = nullptr;
    MonotonicTime began;
    MonotonicTime deadline;
    double timeout_s = 0;
    std::vector<double> target;
    std::optional<MonotonicTime> under_way_at;
  };

  bool answer_known(const Inbound& message, const AttemptKey& key, Outbox& out);
  std::optional<Error> refusal(const Execute& order);
  bool begin(const Inbound& message, const Execute& order, Now now, Outbox& out);
  Status hand_over(const Execute& order, const Skill& skill, Now now, Outbox& out);
  void look_at(std::string_view name, const std::vector<double>& numbers, Now now, Outbox& out);
  [[nodiscard]] bool reached(std::string_view name, const std::vector<double>& numbers) const;
  [[nodiscard]] std::optional<MonotonicTime> timed_end() const;
  void halt(Now now, Outbox& out);
  void end(TaskOutcome outcome, const std::string& reason, std::string data, Now now, Outbox& out);
  void keep(Outcome outcome, Now now, Outbox& out);

  RobotSide& robot_;
  std::optional<Running> running_;
  Outcomes outcomes_;
};

}  // namespace trb::adapter
