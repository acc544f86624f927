#include "tests/support/node_folder.hpp"

#include <doctest/doctest.h>
#include <stdlib.h>

#include <filesystem>

#include "common/base/files.hpp"
#include "common/security/authority.hpp"
#include "common/security/node_keys.hpp"
#include "proto/body.hpp"

namespace trb {
namespace {

constexpr const char* kNetwork = R"({"_comment": "a", "UDP_PORT": 50000, "_comment": {"b": ""}, "TCP_PORT_EXT": 45000,
  "TCP_PORT": 40000, "HOST_INT": "127.0.77.1", "VPN_INT": "tun0"})";
constexpr const char* kProfile = R"({"ros": "ros", "ur": "direct", "abb": "interpreter", "lines": "interpreter"})";
constexpr const char* kCommands = R"json({"ur": {"port": 30002, "language": "urscript", "wrap": "urscript-program",
    "monitor": {"protocol": "ur-primary", "port": 30001},
    "commands": {"move": "movej({data})", "go": "movej({0}, a={1})", "stop": "stop program", "release": ""},
    "requests": {"position": "joints"}},
  "ros": {"commands": {"move": "/cmd_vel", "go": "/goal geometry_msgs/Point {\"x\": {0}}", "stop": "/cmd_vel {}"},
    "requests": {"position": "/odom pose.x"}}})json";
constexpr const char* kPlaces = R"({"places": {"dock": {"x": 1, "y": 2}}})";
constexpr const char* kRobot = R"({"maker": "m", "model": "n", "capabilities": ["mobile"],
  "skills": {"go": {"capability": "mobile", "parameters": {"place": {"type": "place"}}, "command": {"data": "{place.x}"},
  "end": {"kind": "acknowledgement"}}}})";

std::string node_json(const std::string& framework) {
  if (framework == "cloud") return R"({"id": "cloud", "role": "cloud", "services": ["router", "scheduler"]})";
  return R"({"id": "r1", "framework": ")" + framework + R"(", "description": "robots/r.json",
    "robot": {"host": "127.0.77.9", "interface": "lo"}, "seeds": [], "beacon": true,
    "services": ["router", "mode-adapter",)" +
         (framework == "ros" || framework == "ridgeback" ? R"( "ros-bridge",)" : "") + R"( "scheduler"]})";
}

}  // namespace

NodeFolder::NodeFolder(const std::string& framework) {
  write("node.json", node_json(framework));
  write("network.json", kNetwork);
  if (framework == "cloud") return;
  write("profile.json", kProfile);
  write("commands.json", kCommands);
  write("places.json", kPlaces);
  write("robots/r.json", kRobot);
  // ROS has no acknowledgements.
  if (framework == "ros") change("robots/r.json", R"("acknowledgement")", R"("time", "duration_s": 2)");
}

void NodeFolder::write(const std::string& name, const std::string& text) const {
  const std::string file = folder_.path + "/" + name;
  REQUIRE(make_dir(std::filesystem::path(file).parent_path().string()).ok());
  REQUIRE(write_file(file, text).ok());
}

void NodeFolder::remove(const std::string& name) const {
  std::filesystem::remove(folder_.path + "/" + name);
}

void NodeFolder::change(const std::string& name, const std::string& from, const std::string& to) const {
  auto text = read_file(folder_.path + "/" + name);
  REQUIRE(text.ok());
  const std::size_t at = text->find(from);
  REQUIRE_MESSAGE(at != std::string::npos, from);
  write(name, text->replace(at, from.size(), to));
}

void NodeFolder::sign(const std::string& id, Role role) const {
  init_crypto();
  REQUIRE(make_request(folder_.path, id, role).ok());
  const auto text = read_file(folder_.path + "/keys/request.json");
  REQUIRE(text.ok());
  const auto request = from_json<SignedRecord>(*text);
  REQUIRE(request.ok());
  const TemporaryFolder fleet;  // its key lies on no node
  auto authority = make_authority(fleet.path + "/authority", "test", "a long passphrase");
  REQUIRE(authority.ok());
  const UtcTime today{1'800'000'000'000'000'000};
  const auto file = sign_request(*authority, fleet.path + "/authority", *request, today, seconds(3600.0 * 24 * 3650));
  REQUIRE(file.ok());
  REQUIRE(write_file(folder_.path + "/keys/certificate.json", certificate_file_to_json(*file)).ok());
}

ConfigFaults without_keys(const ConfigFaults& faults) {
  ConfigFaults out;
  for (const ConfigFault& fault : faults) {
    if (!fault.file.starts_with("keys")) out.push_back(fault);
  }
  return out;
}

}  // namespace trb
