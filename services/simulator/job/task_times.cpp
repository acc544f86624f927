#include "services/simulator/job/task_times.hpp"

#include <utility>

namespace trb::simulator {

void TaskTimes::on_message(const counting::CountedMessage& message) {
  if (message.phase != CostPhase::task || message.from.party != counting::Party::robot) return;
  const std::string robot = "r" + std::to_string(message.from.of);
  if (at_work_.contains(robot)) return end(robot, message.at_s);
  begin("t" + std::to_string(begun_), robot, message.at_s);
}

void TaskTimes::watch(world::World& world) {
  for (const auto& [id, node] : world.nodes()) {
    world::Robot* robot = node->robot();
    if (robot == nullptr) continue;
    robot->on_begin = [this, &world, &node = *node, then = std::move(robot->on_begin)] {
      begin(node.order().key.task, node.plan().id, world.seconds_passed());
      then();
    };
    robot->on_end = [this, &world, &node = *node, then = std::move(robot->on_end)] {
      end(node.plan().id, world.seconds_passed());
      then();
    };
    robot->on_give_up = [this, &world, &id = id] { fail(id, world.seconds_passed()); };
  }
}

void TaskTimes::begin(const std::string& task, const std::string& robot, double at_s) {
  at_work_[robot] = begun_++;
  if (attempts_.size() < kMaxListedTasks) attempts_.push_back({task, robot, at_s});
}

void TaskTimes::end(const std::string& robot, double at_s) {
  const auto at = at_work_.find(robot);
  if (at == at_work_.end()) return;
  ++done_;
  if (at->second < attempts_.size()) attempts_[at->second].end_s = at_s;
  at_work_.erase(at);
}

void TaskTimes::fail(const std::string& robot, double at_s) {
  const auto at = at_work_.find(robot);
  if (at == at_work_.end()) return;
  if (at->second < attempts_.size()) attempts_[at->second].failed_s = at_s;
  at_work_.erase(at);
}

Value TaskTimes::listed() const {
  Value::List out;
  for (const Attempt& one : attempts_) {
    Value::Object attempt{{"id", Value{one.task}}, {"robot", Value{one.robot}}, {"begin_s", Value{one.begin_s}}};
    if (one.end_s >= 0) attempt.emplace_back("end_s", Value{one.end_s});
    if (one.failed_s >= 0) attempt.emplace_back("failed_s", Value{one.failed_s});
    out.push_back(Value{std::move(attempt)});
  }
  return Value{std::move(out)};
}

}  // namespace trb::simulator
