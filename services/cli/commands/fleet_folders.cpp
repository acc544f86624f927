#include "services/cli/commands/fleet_folders.hpp"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "common/config/node_config.hpp"
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

}  // namespace

std::map<std::string, NodeProfile> read_fleet_folders(const std::string& dir, ConfigFaults& faults) {
  std::map<std::string, NodeProfile> out;
  for (const std::string& folder : node_folders(dir)) {
    const NodeCheck check = check_node_dir(folder, true, drivers::robot_transports());
    for (const ConfigFault& fault : faults_that_stop(check.faults)) faults.push_back(fault);
    if (check.config.role != Role::robot || check.config.framework.empty()) continue;
    NodeProfile profile;
    profile.capabilities = check.config.description.capabilities;
    profile.skills = skill_infos(check.config.description);
    profile.places = place_names(check.config.description, check.config.places);
    out.emplace(check.config.id, std::move(profile));
  }
  if (out.empty() && faults.empty()) {
    faults.push_back({dir, "", "no folder of a robot's node is here", "name the folder that has them side by side"});
  }
  return out;
}

}  // namespace trb::cli
