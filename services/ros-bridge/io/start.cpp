#include "services/ros-bridge/io/start.hpp"

#include "common/config/node_config.hpp"
#include "common/supervisor/process.hpp"
#include "services/ros-bridge/io/message_files.hpp"
#include "services/ros-bridge/io/worker_process.hpp"

namespace trb::ros {
namespace {

constexpr std::uint16_t kMasterPort = 11311;

/// A ROS name: letters, digits, underscores.
std::string node_name(const std::string& id) {
  std::string name = "trb_" + id;
  for (char& c : name) {
    if (c == '-' || c == '.') c = '_';
  }
  return name;
}

}  // namespace

Result<int> start(NodeConfig config) {
  auto service = Service::open({config.dir, "ros-bridge", {std::string(BridgeCommand::kSubtype)}});
  if (!service) return service.error();
  const std::string master =
      "http://" + config.robot.host + ":" + std::to_string(config.commands.port.value_or(kMasterPort)) + "/";
  const std::vector<std::string> folders = {config.dir + "/msg", "/usr/share", "/opt/ros/noetic/share"};
  BridgeCore core({config.id, master, (*service)->instance()},
                  [folders](const std::string& type) { return read_message_file(folders, type); });
  const WorkerProcess worker(**service, core,
                             {supervisor::program_dir() + "/trb-ros-worker", master, config.network.robot_address,
                              node_name(config.id), "/" + config.robot.ros_namespace});
  return (*service)->run(core);
}

}  // namespace trb::ros
