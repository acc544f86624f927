#include "common/scenario/run_start.hpp"

#include <doctest/doctest.h>

#include "common/security/keys.hpp"
#include "proto/body.hpp"

using namespace trb;

namespace {

Member member(std::string id, Role role) {
  Certificate certificate;
  certificate.id = id;
  certificate.role = role;
  SignedRecord record{"certificate", "", {encode(certificate)}, {}};
  return {std::move(id), std::move(record)};
}

RunStart start_for(const std::vector<std::string>& robots) {
  Scenario scenario;
  for (const std::string& robot : robots) {
    Task task;
    task.id = "task-" + std::to_string(scenario.tasks.size());
    task.robot = robot;
    scenario.tasks.push_back(task);
  }
  std::vector<Member> members{member("cloud", Role::cloud), member("a", Role::robot), member("b", Role::robot)};
  return build_run_start(scenario, members, "cloud", {10}, {20}, std::string(32, '7'));
}

Errc fault_of(const RunStart& start) {
  const auto status = check_run_start(start);
  return status ? Errc::ok : status.error().code;
}

}  // namespace

TEST_CASE("the cloud votes only where the robots' number is even") {
  CHECK(start_for({"a", "b", "a"}).electorate == std::vector<std::string>{"a", "b", "cloud"});
  CHECK(start_for({"a", "a"}).electorate == std::vector<std::string>{"a"});
}

TEST_CASE("what is built passes the check") {
  const RunStart start = start_for({"a", "b"});
  CHECK(start.digest.bytes == digest(encode(start.scenario)));
  CHECK(start.first.robots == std::vector<std::string>{"a", "b"});
  CHECK(fault_of(start) == Errc::ok);
}

TEST_CASE("a task bound late goes to whom the submitter has chosen, and stays open to others") {
  RunStart start = start_for({"a", "b"});
  Scenario scenario = start.scenario;
  scenario.tasks[1].robot.clear();
  scenario.tasks[1].requires_ = {"mobile"};
  start = build_run_start(scenario, start.members, "cloud", {10}, {20}, std::string(32, '7'), {"a", "a"});
  CHECK(start.first.robots == std::vector<std::string>{"a", "a"});
  CHECK(start.scenario.tasks[1].robot.empty());
  CHECK(start.electorate == std::vector<std::string>{"a"});
  CHECK(fault_of(start) == Errc::ok);
}

TEST_CASE("a task that the cloud holds until it is due gives it no vote: it has one where the robots' number is even") {
  RunStart start = start_for({"a", "b", "b"});
  Scenario scenario = start.scenario;
  for (const std::size_t late : {1U, 2U}) {
    scenario.tasks[late].robot.clear();
    scenario.tasks[late].requires_ = {"mobile"};
  }
  const auto electorate = [&](const std::vector<std::string>& robots) {
    start = build_run_start(scenario, start.members, "cloud", {10}, {20}, std::string(32, '7'), robots);
    CHECK(start.first.robots == robots);
    CHECK(fault_of(start) == Errc::ok);
    return start.electorate;
  };
  CHECK(electorate({"a", "cloud", "cloud"}) == std::vector<std::string>{"a"});
  CHECK(electorate({"a", "cloud", "b"}) == std::vector<std::string>{"a", "b", "cloud"});
  scenario.tasks[0] = scenario.tasks[2];
  scenario.tasks[0].id = "task-0";
  CHECK(electorate({"cloud", "cloud", "cloud"}) == std::vector<std::string>{"cloud"});
}

TEST_CASE("a start that contradicts itself is refused") {
  const auto changed = [](auto change) {
    RunStart start = start_for({"a", "b"});
    change(start);
    return fault_of(start);
  };
  CHECK(changed([](RunStart& start) { start.run = "short"; }) == Errc::bad_value);
  CHECK(changed([](RunStart& start) { start.priority = 9; }) == Errc::ok);
  CHECK(changed([](RunStart& start) { start.priority = 10; }) == Errc::bad_value);
  CHECK(changed([](RunStart& start) { start.run[0] = 'X'; }) == Errc::bad_value);
  CHECK(changed([](RunStart& start) { start.scenario.name = "other"; }) == Errc::conflict);
  CHECK(changed([](RunStart& start) { start.members.push_back(start.members[1]); }) == Errc::duplicate);
  CHECK(changed([](RunStart& start) { start.submitter = "stranger"; }) == Errc::bad_value);
  CHECK(changed([](RunStart& start) { start.electorate.push_back("stranger"); }) == Errc::bad_value);
  CHECK(changed([](RunStart& start) { start.electorate.clear(); }) == Errc::bad_value);
  CHECK(changed([](RunStart& start) { start.first.robots.pop_back(); }) == Errc::bad_value);
  CHECK(changed([](RunStart& start) { start.first.robots[0] = "stranger"; }) == Errc::bad_value);
  CHECK(changed([](RunStart& start) { start.first.robots[0] = "b"; }) == Errc::conflict);
  CHECK(changed([](RunStart& start) { start.first.epoch = 2; }) == Errc::conflict);
  CHECK(changed([](RunStart& start) { start.expires = start.created; }) == Errc::bad_value);
  CHECK(changed([](RunStart& start) { start.expires = INT64_MAX; }) == Errc::bad_value);
  CHECK(changed([](RunStart& start) { start.created = INT64_MAX - 1; }) == Errc::bad_value);
  CHECK(changed([](RunStart& start) { start.created = INT64_MIN; }) == Errc::bad_value);
}
