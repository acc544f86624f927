// The scheduler's side: carries out one skill at a time; every attempt has one outcome.
#pragma once

#include <map>
#include <utility>

#include "services/mode-adapter/core/outcomes.hpp"
#include "services/mode-adapter/core/robot_side.hpp"

namespace trb::adapter {

/// message          | unknown attempt                     | running            | halting    | ended
/// -----------------|-------------------------------------|--------------------|------------|------------
/// Execute          | begins; Nack; or failed at once     | "running"          | "running"  | its Outcome
/// CancelExecution  | failed, so that it never begins     | halting, "running" | "running"  | its Outcome
///  with `begun`    | the same, and a halt is owed        | -                  | -          | -
/// ExecutionQuery   | "unknown"                           | "running"          | "running"  | its Outcome
///
/// event                                   | running                      | halting
/// ----------------------------------------|------------------------------|---------------------------------------
/// its time-out; a fault that ends it      | halting                      | -
/// its end is reported; its place is seen  | finished, failed             | the same: it came before the halt
/// a state or a time that ends it          | finished, failed             | -: the halt may have brought it about
/// the robot has the halt                  | -                            | failed
/// silence_bound() and 1 s have passed     | -                            | failed: a lost link would have shown
/// the robot refuses the halt              | -                            | interrupted: nobody knows
/// a stop; the link is lost                | interrupted: nobody knows, and a halt is owed
///
/// A state that a robot tells by itself may belong to the time before the command (Driver::values_lag). It ends the
/// skill once it has changed since the robot has the command, or has stayed as it is for 2 s, or half the skill's
/// time-out: the task of a robot that answers at once may be over before a change is seen.
///
/// A halt that is owed is given again at the mode's LinkUp, unless the robot is fenced. Until it is confirmed or
/// refused, or as long as above, nothing begins. Refused, it is still owed. A confirmed stop pays it, too. What a
/// process owed as it ended, and what it had the robot do, the scheduler tells the next one by `begun`.
class SkillDesk {
 public:
  explicit SkillDesk(RobotSide& robot) : robot_(robot) {}

  /// `barred`: why nothing may begin, if so. True: the skill has begun.
  bool execute(const Inbound& message, const Execute& order, const std::optional<Error>& barred, Now now, Outbox& out);
  void cancel(const Inbound& message, const CancelExecution& order, bool fenced, Now now, Outbox& out);
  /// False: no such attempt is known here; who asks has given it, or is about to.
  bool query(const Inbound& message, const ExecutionQuery& query, Outbox& out);
  void journaled(const OutcomeJournaled& outcome) { outcomes_.acknowledge(outcome.key); }

  /// A skill runs or is halted, or the robot is told what it may have missed.
  [[nodiscard]] bool busy() const { return running_ || (owed_ && owed_->until); }
  /// The scheduler has yet to journal how a skill has ended.
  [[nodiscard]] bool owes_outcome(Now now) const { return outcomes_.wait(now); }
  /// True once after an outcome was told: the scheduler takes the robot for free by it.
  bool take_told() { return std::exchange(told_, false); }
  [[nodiscard]] bool owns(Token token) const { return running_ && running_->token == token; }

  /// The robot has received the command.
  void on_under_way(Now now);
  void on_ended(const Ended& ended, Now now, Outbox& out);
  void on_refused(const Error& error, Now now, Outbox& out);
  void on_halted(const Halted& halted, Now now, Outbox& out);
  void on_values(const Driver* mode, Now now, Outbox& out);
  /// Information from the robot to its own node may be the state or position that ends a skill.
  void on_information(const Driver* mode, std::string_view subtype, BytesView data, Now now, Outbox& out);
  /// A fault that takes the running skill's capability away: if no other event would end the skill, it is halted.
  void on_fault(std::string_view capability, Severity severity, const std::string& text, Now now, Outbox& out);
  void on_link_up(Driver& mode, bool fenced, Now now, Outbox& out);
  void on_link_down(const Driver* mode, const std::string& reason, Now now, Outbox& out);
  /// The robot has confirmed a stop.
  void on_stopped(const Driver* mode);
  void interrupt(const std::string& reason, Now now, Outbox& out);

  void tick(Now now, Outbox& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  struct Halting {
    std::string reason;   ///< why it is halted
    MonotonicTime until;  ///< then the robot has the halt, if its link is not known to be lost
  };
  struct Owed {  ///< a halt that may have been lost
    Driver* mode = nullptr;
    Token token = 0;
    std::optional<MonotonicTime> until{};  ///< as above; none: it is not given again yet
  };
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
    std::optional<Halting> halting{};
    std::optional<double> state{};  ///< the last one heard of a state that may lag, also before the command
    bool state_heard = false;       ///< since it is under way
    bool state_counts = false;      ///< it is known to belong to this command
  };

  bool answer_known(const Inbound& message, const AttemptKey& key, Outbox& out);
  std::optional<Error> refusal(const Execute& order);
  bool begin(const Inbound& message, const Execute& order, Now now, Outbox& out);
  Status hand_over(const Execute& order, const Skill& skill, Now now, Outbox& out);
  void look_at(std::string_view name, const std::vector<double>& numbers, Now now, Outbox& out);
  /// Does its end show in a state that may be older than the command?
  [[nodiscard]] bool state_lags() const;
  void note_state(const Driver* mode, std::string_view name, const std::vector<double>& numbers);
  void on_lagging_state(const std::vector<double>& numbers, Now now, Outbox& out);
  /// When the last state counts even if it has not changed.
  [[nodiscard]] std::optional<MonotonicTime> settled_at() const;
  [[nodiscard]] bool reached(std::string_view name, const std::vector<double>& numbers) const;
  /// Does a value of the robot's show its end now?
  [[nodiscard]] bool ends_by_value() const;
  [[nodiscard]] std::optional<MonotonicTime> timed_end() const;
  [[nodiscard]] std::optional<MonotonicTime> limit() const;
  void halt(const std::string& reason, Now now, Outbox& out);
  /// What an earlier process gave the robot is halted, at once if the robot is there.
  void owe_halt(std::string_view skill, bool fenced, Now now, Outbox& out);
  void on_limit(Now now, Outbox& out);
  void end(TaskOutcome outcome, const std::string& reason, std::string data, Now now, Outbox& out);
  void keep(Outcome outcome, Now now, Outbox& out);

  RobotSide& robot_;
  std::optional<Running> running_;
  std::optional<Owed> owed_;
  struct Heard {
    const Driver* mode = nullptr;
    double number = 0;
  };
  std::map<std::string, Heard, std::less<>> heard_;  ///< by the skills' states: the last one of the present link
  Outcomes outcomes_;
  bool told_ = false;
};

}  // namespace trb::adapter
