#include "services/simulator/job/task_times.hpp"

#include <utility>

namespace trb::simulator {

void TaskTimes::on_message(const counting::CountedMessage& message) {
  if (message.phase != CostPhase::task || message.from.party != counting::Party::robot) return;
  const std::string robot = "r" + std::to_string(message.from.of);
  if (at_work_.contains(robot)) return end(robot, message.at_s);
  begin(0, "t" + std::to_string(runs_.front().begun), robot, message.at_s);
}

void TaskTimes::watch(world::World& world) {
  runs_.resize(world.runs().size());
  for (const auto& [id, node] : world.nodes()) {
    world::Robot* robot = node->robot();
    if (robot == nullptr) continue;
    robot->on_begin = [this, &world, &node = *node, then = std::move(robot->on_begin)] {
      const AttemptKey& key = node.order().key;
      const world::WorldRun* run = world.find_run(key.run);
      if (run != nullptr) begin(run->index, key.task, node.plan().id, world.seconds_passed());
      then();
    };
    robot->on_end = [this, &world, &node = *node, then = std::move(robot->on_end)] {
      end(node.plan().id, world.seconds_passed());
      then();
    };
    robot->on_give_up = [this, &world, &id = id] { fail(id, world.seconds_passed()); };
  }
}

void TaskTimes::begin(std::size_t run, const std::string& task, const std::string& robot, double at_s) {
  OfRun& of = runs_[run];
  at_work_[robot] = {run, of.begun++};
  const bool is_listed = of.attempts.size() + 1 == of.begun && of.begun <= kMaxListedTasks && listed_ < kMaxListedInAll;
  if (!is_listed) return;
  of.attempts.push_back({task, robot, at_s});
  ++listed_;
}

TaskTimes::Attempt* TaskTimes::attempt_at(const Place& place) {
  auto& attempts = runs_[place.run].attempts;
  return place.attempt < attempts.size() ? &attempts[place.attempt] : nullptr;
}

void TaskTimes::end(const std::string& robot, double at_s) {
  const auto at = at_work_.find(robot);
  if (at == at_work_.end()) return;
  ++done_;
  if (Attempt* attempt = attempt_at(at->second)) attempt->end_s = at_s;
  at_work_.erase(at);
}

void TaskTimes::fail(const std::string& robot, double at_s) {
  const auto at = at_work_.find(robot);
  if (at == at_work_.end()) return;
  if (Attempt* attempt = attempt_at(at->second)) attempt->failed_s = at_s;
  at_work_.erase(at);
}

std::size_t TaskTimes::not_listed(std::size_t run) const {
  return runs_[run].begun - runs_[run].attempts.size();
}

Value TaskTimes::listed(std::size_t run) const {
  Value::List out;
  for (const Attempt& one : runs_[run].attempts) {
    Value::Object attempt{{"id", Value{one.task}}, {"robot", Value{one.robot}}, {"begin_s", Value{one.begin_s}}};
    if (one.end_s >= 0) attempt.emplace_back("end_s", Value{one.end_s});
    if (one.failed_s >= 0) attempt.emplace_back("failed_s", Value{one.failed_s});
    out.push_back(Value{std::move(attempt)});
  }
  return Value{std::move(out)};
}

}  // namespace trb::simulator
