#include "common/config/sensor_files.hpp"

#include <algorithm>
#include <filesystem>

#include "common/config/json_file.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxFiles = 200;

}  // namespace

std::vector<SensorRule> read_sensor_files(const std::string& node_dir, ConfigFaults& faults) {
  std::vector<std::string> names;
  std::error_code problem;  // no such folder: no rules
  for (const auto& entry : std::filesystem::directory_iterator(node_dir + "/sensors", problem)) {
    if (entry.path().extension() == ".json") names.push_back("sensors/" + entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  if (!check_count({"sensors", faults}, "", names.size(), kMaxFiles)) names.resize(kMaxFiles);
  std::vector<SensorRule> rules;
  for (const std::string& name : names) {
    const auto json = load_json(node_dir + ("/" + name), "name a file that is there", {name, faults});
    if (json) rules.push_back(read_sensor_rule(*json, name, faults));
  }
  return rules;
}

}  // namespace trb
