// The files below config/ are read by the same code as a user's.
#include <doctest/doctest.h>

#include <filesystem>

#include "common/base/files.hpp"
#include "common/scenario/definition.hpp"
#include "tests/support/node_folder.hpp"
#include "tests/support/paths.hpp"

using namespace trb;

namespace {

const std::string kConfig = test::source_dir() + "/config/";
/// Robots with a field channel, as the end-to-end tests use them.
const std::string kFieldRobots = "../tests/support/robots/";

std::string text_of(const std::string& name) {
  auto bytes = read_file(kConfig + name);
  REQUIRE_MESSAGE(bytes.ok(), name);
  return *bytes;
}

Value json_of(const std::string& name) {
  auto json = parse_json(text_of(name));
  REQUIRE_MESSAGE(json.ok(), name);
  return *json;
}

/// A node with the shipped files; only HOST_INT is this machine's.
NodeCheck check_shipped(const std::string& id, const std::string& framework, const std::string& robot) {
  const NodeFolder folder(framework);
  for (const char* file : {"network.json", "profile.json", "commands.json", "places.json"})
    folder.write(file, text_of(file));
  folder.write("robots/r.json", text_of(robot));
  folder.change("network.json", "\"eth0\"", "\"127.0.77.1\"");
  folder.change("node.json", "\"r1\"", "\"" + id + "\"");
  return folder.check();
}

NodeProfile profile_of(const NodeConfig& config) {
  NodeProfile profile;
  profile.skills = skill_infos(config.description);
  profile.places = place_names(config.description, config.places);
  return profile;
}

/// The robot's framework, and its description.
using Shipped = std::map<std::string, std::pair<std::string, std::string>>;

void check_paper_scenario(const Shipped& robots) {
  std::map<std::string, NodeProfile> profiles;
  for (const auto& [id, robot] : robots) {
    const NodeCheck check = check_shipped(id, robot.first, robot.second);
    CHECK_MESSAGE(without_keys(check.faults).empty(), to_text(check.faults));
    profiles[id] = profile_of(check.config);
  }
  ConfigFaults faults;
  const Scenario scenario = read_scenario(json_of("scenarios/paper-nine-tasks.json"), "paper-nine-tasks.json", faults);
  CHECK(scenario.tasks.size() == 9);
  check_scenario(scenario, profiles, "paper-nine-tasks.json", faults);
  CHECK_MESSAGE(faults.empty(), to_text(faults));
}

}  // namespace

TEST_CASE("every shipped description is good") {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kConfig + "robots")) {
    if (entry.path().extension() != ".json") continue;
    const std::string name = entry.path().filename().string();
    ConfigFaults faults;
    read_description(json_of("robots/" + name), name, faults);
    CHECK_MESSAGE(faults.empty(), to_text(faults));
    ++count;
  }
  CHECK(count == 13);
}

TEST_CASE("the conveyor's registers and its description fit each other") {
  const NodeCheck check = check_shipped("conveyor", "plc", "robots/conveyor.json");
  CHECK_MESSAGE(without_keys(check.faults).empty(), to_text(check.faults));
  CHECK(check.config.commands.transport == "modbus");
}

TEST_CASE("the shipped MiR is ready to be spoken to by HTTP") {
  const NodeCheck check = check_shipped("mir", "mir", "robots/mir100.json");
  CHECK_MESSAGE(without_keys(check.faults).empty(), to_text(check.faults));
  CHECK(check.config.commands.transport == "http-json");
}

TEST_CASE("the shipped Dobot is ready to be spoken to in text") {
  const NodeCheck check = check_shipped("arm", "dobot", "robots/dobot-cr5.json");
  CHECK_MESSAGE(without_keys(check.faults).empty(), to_text(check.faults));
  CHECK(check.config.commands.transport == "tcp-dialogue");
}

TEST_CASE("the paper's scenario can be done by the shipped robots, and by robots that speak in fields") {
  const std::pair<std::string, std::string> ur3{"ur", "robots/ur3.json"};
  check_paper_scenario({{"ridgeback", {"ridgeback", "robots/ridgeback.json"}},
                        {"conveyor", {"plc", "robots/conveyor.json"}},
                        {"drone", {"ardrone", "robots/drone.json"}},
                        {"turtlebot", {"ros", "robots/turtlebot.json"}},
                        {"pioneer1", {"pioneer", "robots/pioneer.json"}},
                        {"ur3", ur3}});
  Shipped in_fields{{"ur3", ur3}};
  for (const char* id : {"ridgeback", "conveyor", "drone", "turtlebot"}) {
    in_fields[id] = {"lines", kFieldRobots + id + ".json"};
  }
  check_paper_scenario(in_fields);
}

TEST_CASE("the scenario that takes values from results can be done by shipped robots") {
  const std::map<std::string, std::pair<const char*, const char*>> robots{
      {"ridgeback", {"ridgeback", "robots/ridgeback.json"}},
      {"drone", {"ardrone", "robots/drone.json"}},
      {"ur3", {"ur", "robots/ur3.json"}},
      {"kuka1", {"kuka", "robots/kuka.json"}}};
  std::map<std::string, NodeProfile> profiles;
  for (const auto& [id, robot] : robots) profiles[id] = profile_of(check_shipped(id, robot.first, robot.second).config);
  profiles["ridgeback"].capabilities = {"mobile", "carry"};
  ConfigFaults faults;
  const Scenario scenario = read_scenario(json_of("scenarios/find-and-fetch.json"), "find-and-fetch.json", faults);
  CHECK(scenario.tasks.size() == 8);
  // No robot is online here: for the check it is enough that one is able.
  for (auto& [id, profile] : profiles) profile.robot = "OFFLINE";
  check_scenario(scenario, profiles, "find-and-fetch.json", faults);
  CHECK_MESSAGE(faults.empty(), to_text(faults));
}

TEST_CASE("the arms that are shipped are spoken to as commands.json says") {
  for (const char* arm : {"abb", "kuka"}) {
    const NodeCheck check = check_shipped(arm, arm, std::string("robots/") + arm + ".json");
    CHECK_MESSAGE(without_keys(check.faults).empty(), to_text(check.faults));
  }
}

TEST_CASE("a scenario's faults: a cycle, an unknown robot, skill and place") {
  const NodeCheck check = check_shipped("ridgeback", "lines", kFieldRobots + "ridgeback.json");
  const auto json = parse_json(R"({"name": "n", "tasks": [
    {"id": "a", "robot": "ridgebak", "skill": "go_to", "data": {"place": "dock"}, "after": ["b"]},
    {"id": "b", "robot": "ridgeback", "skill": "go_too", "after": ["a"]},
    {"id": "c", "robot": "ridgeback", "skill": "go_to", "data": {"place": "dok"}}]})");
  REQUIRE(json.ok());
  ConfigFaults faults;
  const Scenario scenario = read_scenario(*json, "s.json", faults);
  check_scenario(scenario, {{"ridgeback", profile_of(check.config)}}, "s.json", faults);
  REQUIRE_MESSAGE(faults.size() == 4, to_text(faults));
  CHECK(faults[0].what.find("a -> b -> a") != std::string::npos);
  CHECK(faults[1].hint == "did you mean 'ridgeback'?");
  CHECK(faults[2].hint == "did you mean 'go_to'?");
  CHECK(faults[3].hint == "did you mean 'dock'?");
}
