#include "common/operator/scenario_check.hpp"

#include "common/operator/routes.hpp"
#include "common/scenario/definition.hpp"

namespace trb::op {
namespace {

ScenarioCheck check(const Scenario& scenario, const std::string& file, ConfigFaults faults, const RouteTable& table) {
  ScenarioCheck out{std::move(faults), {}};
  const Profiles profiles = profiles_of(table);
  if (out.faults.empty()) warn_of_skips(scenario, file, out.faults);  // a graph with faults tells nothing of them
  check_scenario(scenario, profiles, file, out.faults);
  warn_of_robots(scenario, profiles, file, out.faults);
  if (!faults_that_stop(out.faults).empty()) return out;
  CandidateIndex candidates(profiles);
  out.without_spare = tasks_without_spare(scenario, candidates);
  return out;
}

}  // namespace

Scenario parse_scenario(const std::string& text, const std::string& file, ConfigFaults& faults) {
  auto json = parse_json(text);
  if (json) return read_scenario(*json, file, faults);
  faults.push_back({file, "", json.error().what, json.error().hint});
  return {};
}

Profiles profiles_of(const RouteTable& table) {
  Profiles out;
  for (const Route& route : table.routes) {
    NodeProfile& profile = out[route.id] = route.profile;
    if (is_reached(route)) continue;
    if (!profile.robot.empty()) profile.robot = route.state;
    for (SensorInfo& info : profile.plugged) info.state = SensorState::unread;
  }
  return out;
}

void check_with_fleet(Session& session, Scenario scenario, std::string file, ConfigFaults faults,
                      const Callback<ScenarioCheck>& done) {
  const auto look = [scenario = std::move(scenario), file = std::move(file), faults = std::move(faults),
                     done](const RouteTable& table) {
    ScenarioCheck out = check(scenario, file, faults, table);
    const bool fits = faults_that_stop(out.faults).size() == faults_that_stop(faults).size();
    if (const Status whole = check_whole(table); !fits && !whole) return done(whole.error());
    done(std::move(out));
  };
  request_routes(session, on_success<RouteTable>(done, look));
}

}  // namespace trb::op
