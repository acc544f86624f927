#include "services/scheduler/test/decision_story.hpp"

#include <algorithm>

#include "common/scenario/run_start.hpp"

namespace trb::scheduler::test {

const std::string kStoryRun(32, 'a');

Scenario ridgeback_does_it() {
  Scenario scenario = nine_tasks();
  for (Task& task : scenario.tasks) {
    if (task.robot == "pioneer") task.robot = "ridgeback";
  }
  return scenario;
}

SignedRecord start_without(Fleet& fleet, const Scenario& scenario, const std::set<std::string>& left_out) {
  std::vector<Member> members = fleet.members();
  std::erase_if(members, [&](const Member& member) { return left_out.contains(member.id); });
  const UtcTime now = fleet.now().utc;
  return fleet.sign("cloud", kSignedRunStart,
                    encode(build_run_start(scenario, members, "cloud", now, now + seconds(3600), kStoryRun)));
}

SignedRecord Decider::decision(std::vector<TaskRuling> rulings, std::vector<std::string> members,
                               const std::function<void(Decision&)>& change) const {
  Outbox out = fleet_.tell("cloud", "cloud", MessageType::request, NeedDefinition{kStoryRun, {}}, 0);
  const Definition definition = sent<Definition>(out).at(0);
  Decision decision;
  decision.run = kStoryRun;
  decision.digest = decode<RunStart>(definition.start.payload.bytes)->digest;
  decision.epoch = static_cast<std::uint32_t>(definition.decisions.size()) + 2;
  if (!definition.decisions.empty()) decision.previous.bytes = digest(definition.decisions.back().payload.bytes);
  decision.by = "cloud";
  decision.person = "Ann";
  decision.reason = "it is the nearest";
  decision.tasks = std::move(rulings);
  for (const std::string& member : members) decision.members.push_back(fleet_.member(member));
  if (change) change(decision);
  return fleet_.sign("cloud", kSignedDecision, encode(decision));
}

void Decider::step() {
  if (!fleet_["cloud"].up) return;
  const RunView view = fleet_.view("cloud", kStoryRun);
  if (view.state != RunState::paused || view.epoch > 1) return;
  std::vector<std::uint16_t> open;
  std::vector<TaskRuling> rulings;
  for (std::size_t i = 0; i < view.tasks.size(); ++i) {
    const TaskView& task = view.tasks[i];
    if (std::find(tasks_.begin(), tasks_.end(), task.id) == tasks_.end()) continue;
    if (task.outcome == TaskOutcome::none && !word) open.push_back(static_cast<std::uint16_t>(i));
    rulings.push_back({task.id, Ruling::move, replacement_, std::max(task.attempt, 1U) + 1,
                       word ? Evidence::word : Evidence::result});
  }
  if (!open.empty()) {
    if (!fleet_[failed_].up || fleet_.now().mono < next_) return;
    next_ = fleet_.now().mono + seconds(1);
    fleet_.tell(failed_, "cloud", MessageType::command, ReleaseTasks{kStoryRun, 1, open});
    return;
  }
  if (!signed_) signed_ = decision(std::move(rulings), {replacement_});
  if (fleet_.now().mono < next_decision_) return;
  next_decision_ = fleet_.now().mono + seconds(1);
  ++decided;
  fleet_.ask("cloud", MessageType::command, RunDecision{*signed_});
}

}  // namespace trb::scheduler::test
