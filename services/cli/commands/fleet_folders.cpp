#include "services/cli/commands/fleet_folders.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/config/sensor_files.hpp"
#include "common/drivers/registry.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/simulation/job_nodes.hpp"

namespace trb::cli {
namespace {

constexpr std::size_t kMostFolders = 1001;  // a cloud node and a thousand robots

std::vector<std::string> node_folders(const std::string& dir) {
  std::vector<std::string> out;
  std::error_code problem;
  for (std::filesystem::directory_iterator at(dir, problem), end; !problem && at != end; at.increment(problem)) {
    if (out.size() < kMostFolders && std::filesystem::exists(at->path() / "node.json", problem)) {
      out.push_back(at->path().string());
    }
  }
  std::ranges::sort(out);
  return out;
}

NodeProfile profile_of(const NodeConfig& config) {
  NodeProfile out;
  out.capabilities = config.description.capabilities;
  out.skills = skill_infos(config.description);
  out.places = place_names(config.description, config.places);
  out.sensors = config.description.sensors;
  return out;
}

void add_rules(const std::string& folder, const std::string& node, FolderSensors& to) {
  ConfigFaults told;  // by the folder's check
  for (SensorRule& rule : read_sensor_files(folder, told)) to[node].push_back(std::move(rule));
}

}  // namespace

std::map<std::string, NodeProfile> read_fleet_folders(const std::string& dir, ConfigFaults& faults,
                                                      FolderSensors* sensors) {
  std::map<std::string, NodeProfile> out;
  std::map<std::string, std::string> folders;  // by id
  for (const std::string& folder : node_folders(dir)) {
    const NodeCheck check = check_node_dir(folder, true, drivers::robot_transports());
    for (const ConfigFault& fault : faults_that_stop(check.faults)) faults.push_back(fault);
    if (const auto [first, is_new] = folders.emplace(check.config.id, folder); !is_new && !check.config.id.empty()) {
      faults.push_back({folder, "id", in_quotes(check.config.id) + " is also the id of " + first->second,
                        "move one of the folders away, or give its node another id"});
    }
    const bool is_cloud = check.config.role == Role::cloud;
    if (sensors != nullptr) add_rules(folder, is_cloud ? simulation::kCloud : check.config.id, *sensors);
    if (check.config.role != Role::robot || check.config.framework.empty()) continue;
    out.emplace(check.config.id, profile_of(check.config));
  }
  if (out.empty() && faults.empty()) {
    faults.push_back({dir, "", "no folder of a robot's node is here", "name the folder that has them side by side"});
  }
  return out;
}

}  // namespace trb::cli
