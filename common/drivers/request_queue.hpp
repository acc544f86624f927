// The commands for a robot that accepts one request at a time and answers each.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "common/drivers/driver.hpp"

namespace trb::drivers {

/// `resume`: the release that follows a halt; `tidy`: the steps of a refused or dropped job that are sent in any case.
enum class Purpose : std::uint8_t { command, halt, stop, release, resume, tidy };

/// Whose answer is awaited. A job that was dropped meanwhile leaves `nobody`: its answer is received and ignored.
enum class Awaits : std::uint8_t { nothing = 0, poll, job, nobody };

/// A command is one or more steps, each with its answer. A stop goes before all that waits and behind what is under
/// way, so that it waits for one answer at most.
///
/// event         | the first job is under way       | it waits
/// --------------|----------------------------------|--------------------------
/// forget        | goes on                          | dropped; with steps done: goes on
/// halt          | dropped, its answer is nobody's  | dropped
/// drop_for_stop | as halt; a stop goes on          | dropped; a stop and a tidy stay
/// hold          | -                                | as if it were not there, unless it stops or halts
///
/// What is dropped when some of it was sent leaves a tidy, if it has steps for one.
template <class Step>
class RequestQueue {
 public:
  static constexpr std::size_t kMost = 64;

  struct Job {
    Purpose purpose{};
    Token token = 0;  ///< of the message, of the one that is halted, or the stop's ticket
    bool skill = false;
    std::vector<Step> steps;
    std::size_t done = 0;  ///< steps that were answered: successfully, or of a stop or a halt
    std::size_t lost = 0;  ///< connections that ended before an answer to it
    // of a stop or a halt, whose other steps are attempted all the same
    std::size_t refusals = 0;                   ///< steps that were refused
    std::optional<Error> refused{};             ///< the first of them
    bool only_busy = true;                      ///< each, because the robot is busy
    std::optional<MonotonicTime> busy_since{};  ///< when that began
    bool told = false;                          ///< that it was refused
    std::optional<MonotonicTime> not_before{};  ///< its next attempt
  };
  using Jobs = std::deque<Job>;

  [[nodiscard]] bool full() const { return jobs_.size() >= kMost; }
  [[nodiscard]] Awaits awaits() const { return awaits_; }

  /// What to send now: `nothing`, a `poll` or the first `job`'s next step.
  [[nodiscard]] Awaits next(bool poll_is_due, MonotonicTime now = {}) const {
    if (awaits_ != Awaits::nothing) return Awaits::nothing;
    const bool ready = !jobs_.empty() && (!held_ || stops(jobs_.front())) &&
                       (!jobs_.front().not_before || *jobs_.front().not_before <= now);
    const bool urgent = ready && jobs_.front().purpose != Purpose::command;
    // A steady stream of commands must not block the polling, nor the other way round.
    if (poll_is_due && (!ready || (!urgent && !polled_last_))) return Awaits::poll;
    return ready ? Awaits::job : Awaits::nothing;
  }
  /// While it is held the robot gets stops and halts only: all else waits, so that it has the time to stand.
  void hold(bool held) { held_ = held; }
  /// When the first job is attempted again; none: it need not wait.
  [[nodiscard]] std::optional<MonotonicTime> next_attempt() const {
    return jobs_.empty() ? std::nullopt : jobs_.front().not_before;
  }
  [[nodiscard]] static bool stops(const Job& job) {
    return job.purpose == Purpose::stop || job.purpose == Purpose::halt;
  }
  void sent(Awaits whose) {
    awaits_ = whose;
    polled_last_ = whose == Awaits::poll;
  }
  Awaits answered() { return std::exchange(awaits_, Awaits::nothing); }

  /// The job whose step is sent now or next. There must be one.
  [[nodiscard]] Job& front() { return jobs_.front(); }
  Job pop() {
    Job job = std::move(jobs_.front());
    jobs_.pop_front();
    return job;
  }

  void add(Job job) { jobs_.push_back(std::move(job)); }
  /// Before the commands, behind stops and halts: a release in front of a halt would let the motion go on. What tidies
  /// up after a dropped job goes before what follows it.
  void add_urgent(Job job) {
    const auto goes_before = [&job](const Job& one) {
      return stops(one) || (one.purpose == Purpose::tidy && !stops(job));
    };
    auto at = waiting();
    while (at != jobs_.end() && goes_before(*at)) ++at;
    jobs_.insert(at, std::move(job));
  }
  [[nodiscard]] bool will_release() const {
    return std::ranges::any_of(
        jobs_, [](const Job& job) { return job.purpose == Purpose::release || job.purpose == Purpose::resume; });
  }
  /// A second stop joins the one that waits, which now has this ticket, and waits no more. False: none waits.
  bool join_stop(Token ticket) {
    const auto at = join(ticket, [](const Job& job) { return job.purpose == Purpose::stop; });
    if (at == jobs_.end()) return false;
    at->told = false;
    at->not_before.reset();
    at->busy_since.reset();
    return true;
  }
  [[nodiscard]] bool will_stop() const {
    return std::ranges::any_of(jobs_, [](const Job& job) { return job.purpose == Purpose::stop; });
  }
  /// Nobody wants them any more.
  void drop_next_attempts() {
    const auto waits = [](const Job& job) { return job.purpose == Purpose::stop && job.not_before; };
    jobs_.erase(std::remove_if(waiting(), jobs_.end(), waits), jobs_.end());
  }
  /// The same for a release; the robot has nothing of the one that waits.
  bool join_release(Token ticket) {
    return join(ticket, [](const Job& job) { return job.purpose == Purpose::release && job.done == 0; }) != jobs_.end();
  }

  [[nodiscard]] bool runs(Token token) const { return std::ranges::any_of(jobs_, is_command(token)); }
  void forget(Token token) {
    const auto at = std::find_if(waiting(), jobs_.end(), is_command(token));
    if (at != jobs_.end() && at->done == 0) jobs_.erase(at);
  }
  /// False: nothing of it was sent, so there is no motion to end.
  bool halt(Token token) {
    const auto at = std::ranges::find_if(jobs_, is_command(token));
    if (at == jobs_.end()) return true;
    const bool under_way = awaits_ == Awaits::job && at == jobs_.begin();
    const bool begun = under_way || at->done > 0;
    if (under_way) awaits_ = Awaits::nobody;
    Job job = std::move(*at);
    jobs_.erase(at);
    if (begun) keep_rest(std::move(job), under_way ? 1 : 0);
    return begun;
  }
  /// Returns the dropped commands.
  Jobs drop_for_stop() {
    const bool interrupts = awaits_ == Awaits::job && jobs_.front().purpose != Purpose::stop;
    if (interrupts) awaits_ = Awaits::nobody;
    const bool begun = !jobs_.empty() && !stops(jobs_.front()) && (interrupts || jobs_.front().done > 0);
    std::optional<Job> first = begun ? std::optional(jobs_.front()) : std::nullopt;
    Jobs dropped;
    for (Job& job : jobs_) {
      if (job.purpose == Purpose::command) dropped.push_back(std::move(job));
    }
    if (begun && first->purpose == Purpose::tidy) jobs_.pop_front();
    std::erase_if(jobs_, [](const Job& job) { return job.purpose != Purpose::stop && job.purpose != Purpose::tidy; });
    if (begun) keep_rest(std::move(*first), interrupts ? 1 : 0);
    return dropped;
  }
  /// Of a job that is given up after `done` and `sent` steps: those that are sent in any case. They go before the
  /// commands.
  void keep_rest(Job job, std::size_t sent) {
    job.steps.erase(job.steps.begin(), job.steps.begin() + static_cast<std::ptrdiff_t>(job.done + sent));
    std::erase_if(job.steps, [](const Step& step) { return !is_always(step); });
    if (job.steps.empty()) return;
    Job tidy;
    tidy.purpose = Purpose::tidy;
    tidy.steps = std::move(job.steps);
    add_urgent(std::move(tidy));
  }
  /// Returns all jobs; no answer is awaited any more.
  Jobs clear() {
    awaits_ = Awaits::nothing;
    polled_last_ = held_ = false;
    return std::exchange(jobs_, {});
  }

 private:
  static bool is_always(const Step& step) {
    if constexpr (requires { step.always(); }) return step.always();
    return false;
  }
  typename Jobs::iterator join(Token ticket, bool (*joins)(const Job&)) {
    const auto at = std::find_if(waiting(), jobs_.end(), joins);
    if (at != jobs_.end()) at->token = ticket;
    return at;
  }
  static auto is_command(Token token) {
    return [token](const Job& job) { return job.purpose == Purpose::command && job.token == token; };
  }
  [[nodiscard]] typename Jobs::iterator waiting() { return jobs_.begin() + (awaits_ == Awaits::job ? 1 : 0); }

  Jobs jobs_;
  Awaits awaits_ = Awaits::nothing;
  bool polled_last_ = false;
  bool held_ = false;
};

}  // namespace trb::drivers
