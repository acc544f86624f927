#include "common/model/scenario_parameters.hpp"

#include <algorithm>

#include "common/scenario/graph.hpp"

namespace trb::model {
namespace {

/// The actors in the order of the tasks. A task that names none has one of its own, which no robot's id can be.
std::vector<std::string> actors_of(const Scenario& scenario, std::size_t& unnamed) {
  std::vector<std::string> out;
  for (const Task& task : scenario.tasks) {
    out.push_back(task.robot.empty() ? "? of " + task.id : task.robot);
    unnamed += task.robot.empty() ? 1 : 0;
  }
  return out;
}

struct Requests {
  std::uint64_t local = 0, remote = 0, unknown = 0;
  std::set<std::string> sensors;
};

Requests requests_of(const Scenario& scenario, const std::vector<std::string>& actors, bool alone) {
  Requests out;
  for (TaskIndex i = 0; i < scenario.tasks.size(); ++i) {
    for (const Condition& condition : scenario.tasks[i].when) {
      const bool local = alone || (!condition.of.empty() && condition.of == actors[chooser_of(scenario, i)]);
      ++(local ? out.local : out.remote);
      out.unknown += condition.of.empty() && !alone ? 1 : 0;
      out.sensors.insert(condition.of + "/" + condition.sensor + "/" + condition.identity);
    }
  }
  return out;
}

std::string counted(std::uint64_t count, const std::string& one, const std::string& more) {
  return count == 1 ? "1 " + one : std::to_string(count) + " " + more;
}

}  // namespace

ScenarioParameters parameters_of(const Scenario& scenario, const std::set<std::string>& interpreted) {
  ScenarioParameters out;
  std::size_t unnamed = 0;
  const std::vector<std::string> actors = actors_of(scenario, unnamed);
  const std::set<std::string> different(actors.begin(), actors.end());
  PaperParameters& p = out.paper;
  p.n = std::max<std::size_t>(different.size(), 1);
  for (const std::string& actor : actors) ++(interpreted.count(actor) != 0 ? p.N_i : p.N_d);
  const Blocks blocks = blocks_of(actors);
  p.k = blocks.k;
  p.sum_m = blocks.sum_m;
  const Requests requests = requests_of(scenario, actors, p.n == 1);
  p.s = requests.sensors.size();
  p.R_l = requests.local;
  p.R_e = requests.remote;
  if (unnamed > 0) {
    out.assumed.push_back(counted(unnamed, "task names", "tasks name") +
                          " no robot: each counts as another robot's, told directly");
  }
  if (requests.unknown > 0) {
    out.assumed.push_back(counted(requests.unknown, "condition names", "conditions name") +
                          " no node of its sensor: each counts as a remote request");
  }
  return out;
}

Status check_named(const Scenario& scenario, std::uint64_t robots) {
  std::set<std::string> named;
  for (const Task& task : scenario.tasks) {
    if (!task.robot.empty()) named.insert(task.robot);
  }
  if (named.size() <= robots) return Done{};
  return fail(Errc::bad_value,
              "n (--robots): the scenario names " + counted(named.size(), "robot", "robots") + ", not " +
                  std::to_string(robots),
              "use at least " + std::to_string(named.size()) + ", or leave it out");
}

}  // namespace trb::model
