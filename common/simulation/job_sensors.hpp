// The sensors of a simulated fleet: what they tell over time, as a job says it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/fleet/object_reader.hpp"
#include "common/simulation/job_nodes.hpp"
#include "common/simulation/planned_sensor.hpp"
#include "proto/bodies/run.hpp"

namespace trb::simulation {

constexpr std::size_t kMaxSensors = 1000;
constexpr std::size_t kMaxSteps = 1000;

using PlannedSensors = std::vector<PlannedSensor>;

/// Key `sensor_values`, optional: [{"node", "name", "kind", "unit", "identity", "every_s", and one of "value",
/// "steps": [{"at", "value"}], "ramp": {"from", "to", "begin", "end"}}], `most` at most. A value is a number, a text,
/// or null: it cannot be read. Times in seconds from the run's submission. What is left out is as that node's profile
/// has it, if it has a sensor of that name. Every fault of the job is added, by its key.
PlannedSensors read_sensor_values(ObjectReader& reader, const JobNodes& nodes, std::size_t most = kMaxSensors);

/// The nodes tell of them, too: of each in place of one of its name.
void plug_in(const PlannedSensors& sensors, std::map<std::string, NodeProfile>& profiles);

/// The nodes of a simulated fleet: its robots and "cloud", which tell of the sensors. A scenario's conditions are
/// checked with these.
std::map<std::string, NodeProfile> with_cloud(std::map<std::string, NodeProfile> robots, const PlannedSensors& sensors);

/// A fault for each condition of the scenario on a sensor that tells no value here, or in another unit; by the
/// scenario's key in the job.
void check_conditions(const PlannedSensors& sensors, const Scenario& scenario, const FileFaults& faults,
                      const std::string& key = "scenario");

}  // namespace trb::simulation
