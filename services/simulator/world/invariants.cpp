#include "services/simulator/world/invariants.hpp"

#include <algorithm>

namespace trb::world {
namespace {

using Texts = std::vector<std::string>;

void check_attempts(const WorldRun& run, Texts& out) {
  for (const auto& [key, times] : run.witness.begun()) {
    if (times > 1) out.push_back(key.task + ": attempt " + std::to_string(key.attempt) + " was begun twice");
  }
  for (const std::string& task : run.witness.doubles()) out.push_back(task + ": two robots were at it at once");
}

void check_robots(const World& world, Texts& out) {
  for (const auto& [id, node] : world.nodes()) {
    Robot* robot = node->robot();
    if (robot != nullptr && robot->overlaps > 0) out.push_back(id + " was told to do two things at once");
    if (node->malformed() > 0) out.push_back(id + " got what it cannot read");
  }
  out.insert(out.end(), world.strangers().begin(), world.strangers().end());
}

bool is_final(const TaskView& task) {
  return task.state == TaskState::finished || task.state == TaskState::skipped;
}

/// An open alert: a person is waited for.
bool is_reported(const World& world, const WorldRun& run) {
  const auto& alerts = world.nodes().at("cloud")->disk().alerts.alerts();
  return std::ranges::any_of(
      alerts, [&](const auto& one) { return one.second.run == run.id && resilience::is_open(one.second); });
}

void check_end(const World& world, const WorldRun& run, Texts& out) {
  if (is_reported(world, run)) return;
  for (const auto& [id, node] : world.nodes()) {
    if (node->is_up() && world.is_open_at(*node, run.id)) out.push_back(id + ": the run is not over");
  }
}

void check_promise(const World& world, const WorldRun& run, Texts& out) {
  const PlayedRun& played = run.outcome;
  const Node& cloud = *world.nodes().at("cloud");
  if (!played.refusal.empty()) out.push_back("the run was refused: " + played.refusal);
  const bool known = world.is_open_at(cloud, run.id) || cloud.disk().archive.over(run.id);
  if (played.accepted && !known) out.emplace_back("the cloud has accepted the run and knows nothing of it");
}

std::set<std::string> finished_on(const Disk& disk, const std::string& run) {
  std::set<std::string> out;
  for (const auto& record : disk.journal) {
    const auto* kept = std::get_if<scheduler::JournalResult>(&record);
    const auto result = kept == nullptr ? Result<TaskResult>(fail(Errc::missing, "no result"))
                                        : decode<TaskResult>(kept->result.payload.bytes);
    if (result && result->key.run == run && result->outcome == TaskOutcome::finished) out.insert(result->key.task);
  }
  const auto record = disk.archive.record(run);
  if (!record) return out;
  for (const TaskView& task : record->view.tasks) {
    if (task.outcome == TaskOutcome::finished) out.insert(task.id);
  }
  return out;
}

/// What a robot has done to its end is on some node's disk.
void check_results(const World& world, const WorldRun& run, Texts& out) {
  std::set<std::string> missing = run.witness.provable();
  for (const auto& [id, node] : world.nodes()) {
    for (const std::string& task : finished_on(node->disk(), run.id)) missing.erase(task);
  }
  for (const std::string& task : missing) out.push_back(task + " was done, and no node knows it");
}

/// Schedulers send again what was not acknowledged for so long; a definition may have to be asked for meanwhile.
constexpr Duration kSentAgain = std::chrono::milliseconds(190);
constexpr int kWays = 4;

/// Where robots do not wait for each other they may all end at the same moment: then the cloud writes one result after
/// the other, and acknowledges the last one so much later.
Duration written_in(const World& world) {
  const bool at_once = world.plan().division.at_once || world.runs().size() > 1;
  const auto robots = static_cast<std::int64_t>(world.plan().fleet.size());
  return at_once ? robots * world.nodes().at("cloud")->disk().commit : Duration{0};
}

void check_repeats(const World& world, Texts& out) {
  const LinkKind& link = world.plan().link;
  const bool unhurt = world.plan().faults.empty() && world.plan().crashes.empty();
  const Duration way = std::max(link.longest(), world.network().slowest());
  const bool calm = unhurt && link.loss == 0 && kWays * way + written_in(world) < kSentAgain;
  if (calm && !world.repeats().first().empty()) out.push_back(world.repeats().first());
}

/// What is on each member's disk of a run that is over must be what the cloud has.
void check_agreement(const World& world, const WorldRun& run, Texts& out) {
  const auto at_cloud = world.nodes().at("cloud")->disk().archive.record(run.id);
  if (!at_cloud) return;
  for (const auto& [id, node] : world.nodes()) {
    const auto record = node->disk().archive.record(run.id);
    if (!record) continue;
    for (std::size_t i = 0; i < record->view.tasks.size(); ++i) {
      const TaskView& one = record->view.tasks[i];
      const TaskView& other = at_cloud->view.tasks[i];
      const bool known = one.outcome != TaskOutcome::none && other.outcome != TaskOutcome::none;
      const bool differ = known && is_final(one) && is_final(other) && one.outcome != other.outcome;
      if (differ) out.push_back(id + " and the cloud do not agree on how " + one.id + " ended");
    }
  }
}

/// Each node's own account of the run against what its robots did.
void check_tasks(const WorldRun& run, const std::string& id, const Node& node, Texts& out) {
  const auto record = node.disk().archive.record(run.id);
  if (!record || record->view.state != RunState::finished) return;
  for (const TaskView& task : record->view.tasks) {
    const std::uint32_t done = run.witness.done(task.id);
    const bool good = task.state == TaskState::finished ? done == 1 : true;
    if (!good)
      out.push_back(id + " says that " + task.id + " is FINISHED; it was done " + std::to_string(done) + " times");
    if (task.state != TaskState::finished && done > 0 && task.reason.empty())
      out.push_back(id + " has not heard that " + task.id + " was done");
  }
}

}  // namespace

std::vector<std::string> broken_invariants(const World& world, const WorldRun& run) {
  const bool is_first = run.index == 0;
  Texts out;
  check_promise(world, run, out);
  check_attempts(run, out);
  if (is_first) check_robots(world, out);
  if (!run.outcome.left_open) check_end(world, run, out);
  check_results(world, run, out);
  if (is_first) check_repeats(world, out);
  check_agreement(world, run, out);
  check_tasks(run, "cloud", *world.nodes().at("cloud"), out);
  return out;
}

}  // namespace trb::world
