#include "services/cli/commands/fleet_folders.hpp"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/config/sensor_files.hpp"
#include "common/drivers/registry.hpp"

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

}  // namespace

std::map<std::string, NodeProfile> read_fleet_folders(const std::string& dir, ConfigFaults& faults,
                                                      FolderSensors* sensors) {
  std::map<std::string, NodeProfile> out;
  for (const std::string& folder : node_folders(dir)) {
    const NodeCheck check = check_node_dir(folder, true, drivers::robot_transports());
    for (const ConfigFault& fault : faults_that_stop(check.faults)) faults.push_back(fault);
    if (check.config.role != Role::robot || check.config.framework.empty()) continue;
    out.emplace(check.config.id, profile_of(check.config));
    ConfigFaults told;  // by the check above
    if (sensors != nullptr) (*sensors)[check.config.id] = read_sensor_files(folder, told);
  }
  if (out.empty() && faults.empty()) {
    faults.push_back({dir, "", "no folder of a robot's node is here", "name the folder that has them side by side"});
  }
  return out;
}

}  // namespace trb::cli
