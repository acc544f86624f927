#include "services/simulator/job/seen.hpp"

#include <string>
#include <utility>

namespace trb::simulator {
namespace {

using world::Fault;
using world::FaultKind;

bool is_of_run(CostPhase phase) {
  return phase == CostPhase::task || phase == CostPhase::forward || phase == CostPhase::fail;
}

std::string computer_of(const counting::End& end) {
  return end.party == counting::Party::cloud ? "cloud" : "r" + std::to_string(end.of);
}

Value text(std::string_view of) {
  return Value{std::string(of)};
}

Value::Object robot_value(double at_s, FaultKind kind, const std::string& node) {
  return {{"at_s", Value{at_s}}, {"kind", text(name_of(kind))}, {"node", Value{node}}};
}

Value::Object fault_value(double at_s, const Fault& fault) {
  Value::Object out{{"at_s", Value{at_s}}, {"kind", text(name_of(fault.kind))}};
  if (!fault.node.empty()) out.emplace_back("node", Value{fault.node});
  if (!fault.other.empty()) out.emplace_back("other", Value{fault.other});
  if (fault.way != world::Way::both) out.emplace_back("way", text(name_of(fault.way)));
  Value::List nodes;
  for (const std::string& id : fault.nodes) nodes.push_back(Value{id});
  if (!nodes.empty()) out.emplace_back("nodes", Value{std::move(nodes)});
  return out;
}

}  // namespace

void Seen::on_message(const counting::CountedMessage& message) {
  const bool to_all = message.to.party == counting::Party::everybody;
  if (!is_of_run(message.phase) || !message.between_computers() || to_all) return;
  send(message.at_s, message.phase, computer_of(message.from), computer_of(message.to));
}

void Seen::watch(world::World& world) {
  world.meter().trace = [this, then = std::move(world.meter().trace)](const world::Sending& sending, CostPhase phase) {
    if (then) then(sending, phase);
    if (!sending.between_computers || !is_of_run(phase)) return;
    send(sending.at_s, phase, std::string(sending.from), std::string(sending.to));
  };
  world.on_fault = [this, &world](const Fault& fault) {
    const bool told_by_robot = fault.kind == FaultKind::fail || fault.kind == FaultKind::repair;
    if (!told_by_robot) happen(fault_value(world.seconds_passed(), fault));
  };
  for (const auto& [id, node] : world.nodes()) {
    world::Robot* robot = node->robot();
    if (robot == nullptr) continue;
    robot->on_fail = [this, &world, &id = id] { happen(robot_value(world.seconds_passed(), FaultKind::fail, id)); };
    robot->on_repair = [this, &world, &id = id] { happen(robot_value(world.seconds_passed(), FaultKind::repair, id)); };
  }
}

void Seen::send(double at_s, CostPhase phase, std::string from, std::string to) {
  if (sent_++ >= kMaxSendings) return;
  sendings_.push_back(Value{Value::Object{{"at_s", Value{at_s}},
                                          {"phase", text(name_of(phase))},
                                          {"from", Value{std::move(from)}},
                                          {"to", Value{std::move(to)}}}});
}

void Seen::happen(Value::Object happening) {
  if (happenings_.size() < kMaxHappenings) happenings_.push_back(Value{std::move(happening)});
}

void Seen::add_to(Value::Object& answer) const {
  answer.emplace_back("sendings", Value{sendings_});
  answer.emplace_back("sendings_not_listed", Value{static_cast<std::int64_t>(sent_ - sendings_.size())});
  answer.emplace_back("happenings", Value{happenings_});
}

}  // namespace trb::simulator
