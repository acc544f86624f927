// Poses that no arm can take, found in the words of commands.json and in a script about to be sent.
#include "common/drivers/tcp-text/reach.hpp"

#include <doctest/doctest.h>

#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

std::string words_of(const Value& data, const std::string& command) {
  Settings settings = ur3();
  NodeConfig config;
  config.framework = "ur";
  config.commands = settings.commands;
  config.commands.commands = {{"go", command}};
  config.description.numbers = {{"reach", 0.5, "m"}};
  config.description.places = {{"there", data}};
  Parameter where;
  where.name = "where";
  where.type = ParameterType::place;
  where.one_of = {"there"};
  Skill skill;
  skill.name = "fetch";
  skill.subtype = "go";
  skill.data = "{where}";
  skill.parameters = {where};
  config.description.skills = {skill};
  ConfigFaults faults;
  check_reach(config, {"commands.json", faults});
  return faults.empty() ? "" : faults.front().what;
}

Value numbers(double x, double y, double z) {
  return *parse_json("[" + std::to_string(x) + "," + std::to_string(y) + "," + std::to_string(z) + ", 0, 0, 0]");
}

}  // namespace

TEST_CASE("poses are found where a script has numbers for them, and nowhere else") {
  const auto poses = poses_in("movel(p[0.1, -0.2,3e-1, 0,0,0])\nx = p[a, 1, 2]\nmap[1,2,3] + p[ 1 , 2, 3]");
  REQUIRE(poses.size() == 2);
  CHECK(poses[0] == std::array<double, 3>{0.1, -0.2, 0.3});
  CHECK(poses[1] == std::array<double, 3>{1, 2, 3});
  for (const char* text : {"p[", "p[1", "p[1,2", "p[1,,2]", "p[nan,1,1]", ""}) CHECK(poses_in(text).empty());
}

TEST_CASE("a pose of the commands or of a skill's place that is out of reach is named before anything is sent") {
  CHECK(words_of(numbers(0.3, 0.1, 0.2), "movel(p{data})").empty());
  CHECK(words_of(numbers(0, 0, 0.69), "movel(p{data})").empty());  // straight up
  CHECK(words_of(numbers(0.8, 0, 0.2), "movel(p{data})") ==
        "the pose p[0.8, 0, 0.2, …] of skill 'fetch' is 0.82 m away from the robot's foot, and its reach is 0.5 m");
  CHECK(words_of(numbers(10, 0, 0), "movej({data})").empty());  // six joints
  CHECK(words_of(numbers(0, 0, 0), "movel(p[10,0,0,0,0,0])").starts_with("the pose p[10, 0, 0, …] is 10 m away"));
}

TEST_CASE("a script that is about to be sent is judged by what the controller says of its arm") {
  const UrReach reach{0.15, 0.61};
  CHECK_FALSE(out_of_reach("movel(p[0.3, 0, 0.6, 0, 0, 0])", reach));
  const auto far = out_of_reach("movel(p[10, 0, 0.15, 0, 0, 0])", reach);
  REQUIRE(far);
  CHECK(far->code == Errc::bad_value);
  CHECK(far->what == "the pose p[10, 0, 0.15, …] is 10 m away from the arm's shoulder, and it reaches 0.61 m at most");
  CHECK_FALSE(out_of_reach("movel(p[10, 0, 0.15, 0, 0, 0])", std::nullopt));
  CHECK_FALSE(out_of_reach("set_tcp(p[0,0,9,0,0,0])\nmovel(p[5,0,0,0,0,0])", reach));
}
