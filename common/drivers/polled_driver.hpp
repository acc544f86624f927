// What the drivers share of robots that take one request at a time and whose values are polled.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/drivers/commands_driver.hpp"
#include "common/drivers/driver_settings.hpp"
#include "common/drivers/polled_values.hpp"
#include "common/drivers/refused_turn.hpp"
#include "common/drivers/request_queue.hpp"

namespace trb::drivers {

/// How faults name what such a robot is and does.
struct PolledWording {
  const char* offline;   ///< "the robot's controller is not connected"
  const char* robot;     ///< "device"
  const char* answered;  ///< "the device had acknowledged"
  const char* step;      ///< "write"
  const char* well;      ///< "done"
};

/// A command is one or more steps. `Words`: of commands.json; `Step`: the same with its data; `Poll`: the rounds.
template <class Words, class Step, class Poll>
class PolledDriver : public CommandsDriver<Words> {
 public:
  [[nodiscard]] const RobotValue* value(std::string_view name) const override {
    return poll_.value(this->name_of_value(name));
  }
  [[nodiscard]] bool answers_from_values() const override { return true; }
  /// A program that samples its inputs, or plans first, shows its new state some time after it has the command.
  [[nodiscard]] bool values_lag(std::string_view) const override { return true; }
  [[nodiscard]] std::optional<Error> problem(std::string_view name) const override {
    return poll_.problem(this->name_of_value(name));
  }

  Result<Progress> hand_over(const Handover& message, Now now, const DriverOut& out) override {
    if (!this->online()) return offline_error();
    if (queue_.full()) {
      return fail(Errc::queue_full, std::string("too many commands wait for the ") + wording_.robot, "send fewer");
    }
    auto steps = fill(message.subtype, message.data);
    if (!steps) return steps.error();
    if (steps->empty()) return Progress::handed_over;
    out.out.count("to_robot." + std::string(message.subtype));
    queue_.add({Purpose::command, message.token, !message.skill.empty(), std::move(*steps), 0});
    pump(now, out);
    return Progress::queued;
  }
  [[nodiscard]] bool runs(Token token) const override { return queue_.runs(token); }
  void forget(Token token, Now, const DriverOut&) override { queue_.forget(token); }

  void halt(Token token, Now now, const DriverOut& out) override {
    if (!queue_.halt(token)) return out.emit(Halted{token});
    if (!takes_orders()) return;
    auto steps = fill("stop", {});
    if (!steps || steps->empty()) return CommandsDriver<Words>::refuse_halt(token, out);
    out.out.count("to_robot.stop");
    queue_.add_urgent({Purpose::halt, token, false, std::move(*steps), 0});
    pump(now, out);
  }
  Result<Token> stop(Now now, const DriverOut& out) override {
    drop_for_stop(out);
    end_hold(out);
    if (!takes_orders() && !up_) return fail(Errc::robot_offline, wording_.offline);
    auto steps = fill("stop", {});
    if (!steps || steps->empty()) return fail(Errc::unknown_subtype, "commands.json has no \"stop\" for this robot");
    this->may_be_stopped_ = fenced_ = true;
    const Token ticket = ++this->last_ticket_;
    if (queue_.join_stop(ticket)) {
      pump(now, out);
      return ticket;
    }
    out.out.count("to_robot.stop");
    queue_.add_urgent({Purpose::stop, ticket, false, std::move(*steps), 0});
    pump(now, out);
    return ticket;
  }
  Result<Token> release(Now now, const DriverOut& out) override {
    fenced_ = false;
    queue_.drop_next_attempts();
    if (!takes_orders()) return fail(Errc::robot_offline, wording_.offline);
    const Token ticket = ++this->last_ticket_;
    auto steps = fill("release", {});
    if (!steps || steps->empty()) {
      this->may_be_stopped_ = false;
      out.emit(Released{ticket});
      return ticket;
    }
    // Else a member could keep the polling out by releases: they are urgent, and he needs no lease for them.
    if (queue_.join_release(ticket)) return ticket;
    out.out.count("to_robot.release");
    queue_.add_urgent({Purpose::release, ticket, false, std::move(*steps), 0});
    pump(now, out);
    return ticket;
  }

 protected:
  using Queue = RequestQueue<Step>;
  using Job = typename Queue::Job;

  PolledDriver(const DriverSettings& settings, Poll poll, const PolledWording& wording)
      : CommandsDriver<Words>(settings.id, settings.commands),
        poll_(std::move(poll)),
        hold_(seconds(hold_s(settings.commands))),
        wording_(wording) {}

  /// The steps of a command of commands.json. Errors: unknown_subtype, bad_value, not_escapable.
  virtual Result<std::vector<Step>> fill(std::string_view subtype, BytesView data) const = 0;
  /// Sends what may be sent now.
  virtual void pump(Now now, const DriverOut& out) = 0;
  /// Why a command is refused while the robot is not online.
  [[nodiscard]] virtual Error offline_error() const {
    return fail(Errc::robot_offline, wording_.offline, "look at its power, network and address");
  }
  /// True while a halt or a release may be sent.
  [[nodiscard]] virtual bool takes_orders() const = 0;

  /// A step of the first job was answered. A stop or a halt attempts each of its steps, whatever the others do.
  void on_step_over(std::optional<Error> refused, bool busy, Now now, const DriverOut& out) {
    Job& job = queue_.front();
    const bool stops = Queue::stops(job);
    if (refused) {
      ++job.refusals;
      job.only_busy = job.only_busy && busy;
      if (!job.refused) job.refused = std::move(refused);
    }
    if (!job.refused || stops) ++job.done;
    if (job.done < job.steps.size() && (!job.refused || stops)) return;
    Job over = queue_.pop();
    if (!over.refused) return on_done(over, now, out);
    if (!stops) queue_.keep_rest(over, 1);
    on_refused(std::move(over), now, out);
  }
  /// The robot has taken all of it.
  virtual void on_done(const Job& job, Now now, const DriverOut& out) = 0;
  void on_refused(Job job, Now now, const DriverOut& out) {
    const Error error = refusal_of(job);
    if (job.purpose == Purpose::command) return out.emit(Refused{job.token, error});
    if (job.purpose == Purpose::tidy) return out.refuse("robot_error", error.text());
    if (Queue::stops(job) && waits_until_free(job, now)) return queue_.add_urgent(again(job, kBusy, now, out));
    if (!job.told) report_refusal(job, error, out);
    if (job.purpose != Purpose::stop || !fenced_ || queue_.will_stop()) return;
    job.told = true;
    queue_.add_urgent(again(job, job.only_busy ? kBusy : kRefused, now, out));
  }
  /// Not only its requester must know at once.
  void report_not_stopped(const Job& job, const Error& error, const DriverOut& out) {
    std::string text = std::string("the ") + wording_.robot + " refused to stop: " + error.what;
    if (job.purpose == Purpose::halt) {
      out.emit(Halted{job.token, false, error.what});
      text += half_taken(job);
    }
    out.emit(refused_turn(true, std::move(text)));
  }
  /// The robot has taken a release.
  void on_released(const Job& job, const DriverOut& out) {
    this->may_be_stopped_ = false;
    if (job.purpose == Purpose::release) out.emit(Released{job.token});
    out.emit(refused_turn_over(false));
  }
  /// The robot has taken a halt. What follows at once would take it back before the robot's program has seen it.
  void on_halt_taken(Token token, Now now, const DriverOut& out) {
    const auto release = fill("release", {});
    if (release && !release->empty()) this->may_be_stopped_ = true;  // a release that is lost is given again
    halted_.push_back(token);
    held_until_ = now.mono + hold_;
    queue_.hold(true);
    look_at_hold(now, out);
  }
  /// Before anything is sent.
  void look_at_hold(Now now, const DriverOut& out) {
    if (!held_until_ || now.mono < *held_until_) return;
    end_hold(out);
    resume(out);
  }
  /// What a halt may take beside the answers to its steps.
  [[nodiscard]] Duration halt_time() const { return hold_ + kBusyPatience; }
  /// When something is due beside the robot's answers.
  [[nodiscard]] std::optional<MonotonicTime> next_own() const {
    const bool waits = up_ && queue_.awaits() == Awaits::nothing;
    return waits ? earlier(held_until_, queue_.next_attempt()) : held_until_;
  }
  /// All that waits, when the robot has gone; after that no Halted comes.
  typename Queue::Jobs clear_queue() {
    halted_.clear();
    held_until_.reset();
    return queue_.clear();
  }
  /// The release of a robot that is in no stop changes nothing: refused, it is no fault.
  void report_not_going_on(const Error& error, const DriverOut& out) const {
    if (!this->may_be_stopped_) return;
    out.emit(
        refused_turn(false, std::string("the ") + wording_.robot + " refused to go on after a stop: " + error.what));
  }

  Poll poll_;
  Queue queue_;
  bool up_ = false;
  bool heard_ = false;  ///< the robot has answered

 private:
  static constexpr Duration kBusy = std::chrono::milliseconds(100);
  static constexpr Duration kRefused = std::chrono::seconds(1);
  /// A robot that is busy for so long counts as one that refuses: before the requester of a stop gives up.
  static constexpr Duration kBusyPatience = std::chrono::milliseconds(1500);

  [[nodiscard]] Error refusal_of(const Job& job) const {
    Error error = *job.refused;
    const std::size_t taken = Queue::stops(job) ? job.done - job.refusals : job.done;
    const std::string number = std::to_string(taken);
    if (taken > 0 && Queue::stops(job)) {
      error.what += "; " + number + " of its " + std::to_string(job.steps.size()) + " " + wording_.step + "s was " +
                    wording_.well;
    } else if (taken > 0) {
      error.what += "; the " + number + " " + wording_.step + "s before it were " + wording_.well;
    }
    return error;
  }
  static bool waits_until_free(Job& job, Now now) {
    if (!job.only_busy || job.told) return false;
    if (!job.busy_since) job.busy_since = now.mono;
    return now.mono - *job.busy_since < kBusyPatience;
  }
  /// Stopping twice does no harm.
  static Job again(Job job, Duration after, Now now, const DriverOut& out) {
    out.out.count("to_robot.stop_again");
    job.done = job.refusals = 0;
    job.refused.reset();
    job.only_busy = true;
    job.not_before = now.mono + after;
    return job;
  }
  void report_refusal(const Job& job, const Error& error, const DriverOut& out) {
    out.refuse("robot_error", error.text());
    if (job.purpose == Purpose::stop) out.emit(NotStopped{job.token, error});
    Queue::stops(job) ? report_not_stopped(job, error, out) : report_not_going_on(error, out);
  }
  /// A halt of which the robot took steps; what its fault says of it then.
  std::string half_taken(const Job& halt) {
    if (halt.done == halt.refusals) return {};
    this->may_be_stopped_ = true;  // it is released when the link is back
    return kMayStand;
  }
  void end_hold(const DriverOut& out) {
    held_until_.reset();
    queue_.hold(false);
    for (const Token token : std::exchange(halted_, {})) out.emit(Halted{token});
  }
  /// A robot that has the halt is in its stop, and would carry out nothing more.
  void resume(const DriverOut& out) {
    auto steps = fill("release", {});
    if (!steps || steps->empty() || queue_.will_release()) return;
    out.out.count("to_robot.release");
    queue_.add_urgent({Purpose::resume, 0, false, std::move(*steps), 0});
  }
  /// The request in progress cannot be recalled; its answer is ignored.
  void drop_for_stop(const DriverOut& out) {
    for (const Job& job : queue_.drop_for_stop()) {
      const std::string done = std::to_string(job.done) + " of its " + std::to_string(job.steps.size());
      out.emit(Refused{job.token, fail(Errc::fenced,
                                       std::string("the robot was stopped when ") + wording_.answered + " " + done +
                                           " " + wording_.step + "s",
                                       "trb release " + this->own_id_)});
    }
  }

  bool fenced_ = false;  ///< told to stop, and not to go on since
  Duration hold_;        ///< how long a halt is held
  std::optional<MonotonicTime> held_until_;
  std::vector<Token> halted_;  ///< whose halts are held
  PolledWording wording_;
};

}  // namespace trb::drivers
