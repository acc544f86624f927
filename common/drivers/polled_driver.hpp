// What the drivers share of robots that take one request at a time and whose values are polled.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/drivers/commands_driver.hpp"
#include "common/drivers/driver_settings.hpp"
#include "common/drivers/refused_turn.hpp"
#include "common/drivers/request_queue.hpp"

namespace trb::drivers {

/// How faults name what such a robot is and does.
struct PolledWording {
  const char* offline;   ///< "the robot's controller is not connected"
  const char* robot;     ///< "device"
  const char* answered;  ///< "the device had acknowledged"
  const char* steps;     ///< "writes"
};

/// A command is one or more steps. `Words`: of commands.json; `Step`: the same with its data; `Poll`: the rounds.
template <class Words, class Step, class Poll>
class PolledDriver : public CommandsDriver<Words> {
 public:
  [[nodiscard]] const RobotValue* value(std::string_view name) const override {
    return poll_.value(this->name_of_value(name));
  }
  [[nodiscard]] bool answers_from_values() const override { return true; }
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
    if (!takes_orders() && !up_) return fail(Errc::robot_offline, wording_.offline);
    auto steps = fill("stop", {});
    if (!steps || steps->empty()) return fail(Errc::unknown_subtype, "commands.json has no \"stop\" for this robot");
    this->may_be_stopped_ = true;
    const Token ticket = ++this->last_ticket_;
    if (queue_.join_stop(ticket)) return ticket;
    out.out.count("to_robot.stop");
    queue_.add_urgent({Purpose::stop, ticket, false, std::move(*steps), 0});
    pump(now, out);
    return ticket;
  }
  Result<Token> release(Now now, const DriverOut& out) override {
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
      : CommandsDriver<Words>(settings.id, settings.commands), poll_(std::move(poll)), wording_(wording) {}

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

  /// The robot has taken a release.
  void on_released(const Job& job, const DriverOut& out) {
    this->may_be_stopped_ = false;
    if (job.purpose == Purpose::release) out.emit(Released{job.token});
    out.emit(refused_turn_over(false));
  }
  /// A robot that has the halt is in its stop, and would carry out nothing more.
  void resume(const DriverOut& out) {
    auto steps = fill("release", {});
    if (!steps || steps->empty()) return;
    this->may_be_stopped_ = true;  // a release that is lost is given again
    if (queue_.will_release()) return;
    out.out.count("to_robot.release");
    queue_.add_urgent({Purpose::resume, 0, false, std::move(*steps), 0});
  }
  /// A halt that was refused behind steps that the robot took; what its fault says of it then.
  std::string half_taken(const Job& halt) {
    if (halt.done == 0) return {};
    this->may_be_stopped_ = true;  // it is released when the link is back
    return kMayStand;
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
  /// The request in progress cannot be recalled; its answer is ignored.
  void drop_for_stop(const DriverOut& out) {
    for (const Job& job : queue_.drop_for_stop()) {
      const std::string done = std::to_string(job.done) + " of its " + std::to_string(job.steps.size());
      out.emit(Refused{job.token, fail(Errc::fenced,
                                       std::string("the robot was stopped when ") + wording_.answered + " " + done +
                                           " " + wording_.steps,
                                       "trb release " + this->own_id_)});
    }
  }

  PolledWording wording_;
};

}  // namespace trb::drivers
