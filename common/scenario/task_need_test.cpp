#include "common/scenario/task_need.hpp"

#include <doctest/doctest.h>

using namespace trb;

namespace {

using Names = std::vector<std::string>;

NodeProfile cart() {
  NodeProfile out;
  out.places = {"dock"};
  out.skills = {
      {"go_to", "mobile", {{"place", "place", true, ""}, {"speed", "number", false, "m/s", {0.1, 1}}}, true, 60}};
  return out;
}

Task drive(std::string data) {
  Task out;
  out.id = "t4";
  out.skill = "go_to";
  out.requires_ = {"mobile"};
  out.data = std::move(data);
  return out;
}

}  // namespace

TEST_CASE("a scenario's task says what it needs") {
  const auto need = need_of(drive(R"({"place": "dock"})"));
  REQUIRE(need);
  CHECK(need->task == "t4");
  CHECK(need->skill == "go_to");
  CHECK(need->capabilities == Names{"mobile"});
  CHECK(need->arguments.size() == 1);
  Task task = drive("[1]");
  CHECK(need_of(task).error().code == Errc::malformed);
  CHECK(need_of(task).error().what == "task 't4': its data is no JSON object");
  task.data = "";
  CHECK(need_of(task)->arguments.empty());
  task.values = {{"to", "scan", "place"}};
  CHECK(need_of(task)->later == Names{"to"});
}

TEST_CASE("a robot takes a task if its skill takes each value, and none is missing") {
  const NodeProfile robot = cart();
  const auto takes = [&](const std::string& data) { return takes_task(*need_of(drive(data)), robot); };
  CHECK(takes(R"({"place": "dock"})"));
  CHECK(takes(R"({"place": "dock", "speed": 1})"));
  CHECK_FALSE(takes(R"({"place": "moon"})"));
  CHECK_FALSE(takes(R"({"place": "dock", "speed": 2})"));
  CHECK_FALSE(takes(R"({"place": "dock", "spede": 1})"));
  CHECK_FALSE(takes("{}"));
}

TEST_CASE("a value that comes from a result is not there yet: its parameter must exist") {
  Task task = drive("{}");
  task.values = {{"place", "scan", ""}};
  CHECK(takes_task(*need_of(task), cart()));
  task.values.push_back({"spede", "scan", ""});
  CHECK_FALSE(takes_task(*need_of(task), cart()));
}

TEST_CASE("without a skill of that name nobody takes it; without a skill at all the parameters are nobody's") {
  Task task = drive("{}");
  task.skill = "fetch";
  CHECK_FALSE(takes_task(*need_of(task), cart()));
  task.skill = "";
  CHECK(takes_task(*need_of(task), cart()));
}

TEST_CASE("faults come in the order of the skill's parameters, unknown names in the order in which they are given") {
  const NodeProfile robot = cart();
  Task task = drive(R"({"speed": 3, "height": 1})");
  task.values = {{"side", "scan", ""}};
  const TaskNeed need = *need_of(task);
  const auto faults = parameter_faults(need, robot.skills[0], robot.places);
  REQUIRE(faults.size() == 2);
  CHECK(faults[0].info.name == "place");
  CHECK(faults[0].value == nullptr);
  CHECK(faults[1].info.name == "speed");
  CHECK(faults[1].misfit == Misfit::range);
  CHECK(unknown_parameters(need, robot.skills[0]) == std::vector<std::string_view>{"height", "side"});
}
