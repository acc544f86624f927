// Plays a plan: every message of the paper's protocol happens, one by one, in the order of time (section 5.1 as a
// story). There is no equation here: what is counted is held against common/model's.
#pragma once

#include <algorithm>
#include <functional>
#include <queue>
#include <type_traits>
#include <vector>

#include "services/simulator/counting/message.hpp"
#include "services/simulator/counting/plan.hpp"
#include "services/simulator/counting/task_text.hpp"

namespace trb::counting {

/// `Take` is called with each CountedMessage.
template <class Take>
class Play {
 public:
  Play(const Plan& plan, Take& take) : plan_(plan), take_(take), text_(plan) {}

  /// Returns the end, s.
  double run() {
    boot();
    form();
    plug_devices();
    begin_scenario();
    for (std::size_t i = 0; i < plan_.tasks.size(); ++i) work(i);
    send_updates_until(std::max(now_, plan_.seconds));
    return std::max(now_, plan_.seconds);
  }

 private:
  struct Update {
    double at_s = 0;
    std::uint32_t device = 0;
    std::uint64_t count = 0;
    bool operator>(const Update& other) const { return at_s != other.at_s ? at_s > other.at_s : device > other.device; }
  };

  static End cloud() { return {Party::cloud, 0}; }
  static End middleware(std::uint32_t robot) { return {Party::middleware, robot}; }
  static End robot(std::uint32_t number) { return {Party::robot, number}; }
  static End device(std::uint32_t number) { return {Party::device, number}; }
  static End everybody() { return {Party::everybody, 0}; }
  [[nodiscard]] std::uint32_t robot_of(std::uint32_t device) const { return device % plan_.robots; }

  void send(CostPhase phase, End from, End to, std::uint64_t bytes = Sizes::kHeader) {
    take_(CountedMessage{now_, phase, from, to, bytes});
  }

  /// The cloud starts each middleware, which answers; the robot waits for what it shall do.
  void boot() {
    for (std::uint32_t i = 0; i < plan_.robots; ++i) {
      send(CostPhase::boot, cloud(), middleware(i));
      send(CostPhase::boot, middleware(i), cloud());
      send(CostPhase::boot, robot(i), middleware(i));
    }
  }

  /// Each that joins broadcasts; who is there already acknowledges with its identity.
  void form() {
    for (std::uint32_t joins = 0; joins < plan_.robots; ++joins) {
      send(CostPhase::identification, middleware(joins), everybody());
      for (std::uint32_t other = 0; other < joins; ++other) {
        send(CostPhase::identification, middleware(other), middleware(joins));
      }
    }
  }

  void plug_devices() {
    for (std::uint32_t i = 0; i < plan_.device_rates.size(); ++i) {
      send(CostPhase::devices, middleware(robot_of(i)), cloud());
      send(CostPhase::devices, middleware(robot_of(i)), everybody());
      plan_update(i, 1);
    }
  }

  void begin_scenario() {
    if (plan_.tasks.empty()) return;
    send(CostPhase::boot, cloud(), middleware(plan_.tasks[0].robot), Sizes::kHeader + text_.size_from(0));
  }

  void work(std::size_t i) {
    const PlannedTask& task = plan_.tasks[i];
    if (task.taken_over) hand_over(i);
    send(CostPhase::task, robot(task.robot), middleware(task.robot));
    if (task.interpreted) {
      for (const std::uint64_t field : Sizes::kFields) {
        send(CostPhase::task, middleware(task.robot), robot(task.robot), field);
      }
    } else {
      send(CostPhase::task, middleware(task.robot), robot(task.robot));
    }
    request_sensors(task);
    const double end_s = plan_.task_s * static_cast<double>(i + 1);  // no sum, whose error grows
    send_updates_until(end_s);
    now_ = end_s;
    send(CostPhase::task, robot(task.robot), middleware(task.robot));
    send(CostPhase::task, middleware(task.robot), cloud(), Sizes::kToCloud);
    if (i + 1 < plan_.tasks.size() && plan_.tasks[i + 1].robot != task.robot) {
      send(CostPhase::forward, middleware(task.robot), middleware(plan_.tasks[i + 1].robot),
           Sizes::kHeader + text_.size_from(i + 1));
    }
  }

  /// Another robot has failed at this task: it tells the cloud, which sends the changed scenario to who takes over.
  void hand_over(std::size_t i) {
    const std::uint32_t takes_over = plan_.tasks[i].robot;
    send(CostPhase::fail, middleware((takes_over + 1) % plan_.robots), cloud());
    send(CostPhase::fail, cloud(), middleware(takes_over), Sizes::kHeader + text_.size_from(i));
  }

  void request_sensors(const PlannedTask& task) {
    for (std::uint32_t i = 0; i < task.local_requests; ++i) {
      send(CostPhase::sensor, middleware(task.robot), device(0));
      send(CostPhase::sensor, device(0), middleware(task.robot), Sizes::kValue);
    }
    const std::uint32_t has_it = (task.robot + 1) % plan_.robots;
    for (std::uint32_t i = 0; i < task.remote_requests; ++i) {
      send(CostPhase::sensor, middleware(task.robot), middleware(has_it));
      send(CostPhase::sensor, middleware(has_it), device(0));
      send(CostPhase::sensor, device(0), middleware(has_it), Sizes::kValue);
      send(CostPhase::sensor, middleware(has_it), middleware(task.robot), Sizes::kValue);
    }
  }

  /// A device's updates come at 1/rate, 2/rate ... s: counted, so that no error of a sum grows.
  void plan_update(std::uint32_t number, std::uint64_t count) {
    const double rate = plan_.device_rates[number];
    if (rate > 0) updates_.push({static_cast<double>(count) / rate, number, count});
  }

  void send_updates_until(double end_s) {
    const double begin_s = now_;
    const double last_s = plan_.seconds > 0 ? std::min(end_s, plan_.seconds) : end_s;
    while (!updates_.empty() && updates_.top().at_s <= last_s) {
      const Update update = updates_.top();
      updates_.pop();
      now_ = std::max(update.at_s, begin_s);
      send(CostPhase::devices, middleware(robot_of(update.device)), cloud(), Sizes::kValue);
      plan_update(update.device, update.count + 1);
    }
    now_ = begin_s;
  }

  const Plan& plan_;
  Take& take_;
  TaskText text_;
  std::priority_queue<Update, std::vector<Update>, std::greater<>> updates_;
  double now_ = 0;
};

template <class Take>
double play(const Plan& plan, Take&& take) {
  return Play<std::remove_reference_t<Take>>(plan, take).run();
}

}  // namespace trb::counting
