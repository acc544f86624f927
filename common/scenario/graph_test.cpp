#include "common/scenario/graph.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

using namespace trb;

namespace {

Task task(std::string id, std::vector<TaskIndex> after = {}) {
  Task out;
  out.id = std::move(id);
  out.robot = "r";
  out.after = std::move(after);
  return out;
}

Scenario diamond() {
  Scenario scenario;
  scenario.tasks = {task("a"), task("b", {0}), task("c", {0}), task("d", {1, 2})};
  return scenario;
}

Errc fault_of(std::vector<Task> tasks) {
  Scenario scenario;
  scenario.tasks = std::move(tasks);
  const auto status = check_graph(scenario);
  return status ? Errc::ok : status.error().code;
}

}  // namespace

TEST_CASE("a graph may fork and join, and nothing else") {
  CHECK(check_graph(diamond()).ok());
  CHECK(fault_of({}) == Errc::bad_value);
  CHECK(fault_of({task("a"), task("a")}) == Errc::duplicate);
  CHECK(fault_of({task("A")}) == Errc::bad_value);
  CHECK(fault_of({task("a", {1})}) == Errc::bad_value);
  CHECK(fault_of({task("a", {0})}) == Errc::bad_value);
  CHECK(fault_of({task("a"), task("b", {0, 0})}) == Errc::duplicate);
  CHECK(fault_of({task("a", {2}), task("b", {0}), task("c", {1})}) == Errc::bad_value);
  CHECK(fault_of(std::vector<Task>(kMaxTasks + 1)) == Errc::too_large);
}

TEST_CASE("what stands on the wire is checked as the file was") {
  const auto changed = [](const std::function<void(Task&)>& change) {
    Task second = task("b", {0});
    change(second);
    return fault_of({task("a"), second});
  };
  CHECK(changed([](Task& is) { is.robot.clear(); }) == Errc::bad_value);
  CHECK(changed([](Task& is) {
          is.robot.clear();
          is.requires_ = {"mobile"};
        }) == Errc::ok);
  CHECK(changed([](Task& is) { is.id = "b#2"; }) == Errc::ok);
  for (const char* id : {"b#1", "b#", "b#02", "b#x", "#2", "b#2#3", "b#10000"}) {
    CAPTURE(id);
    CHECK(changed([&](Task& is) { is.id = id; }) == Errc::bad_value);
  }
  CHECK(changed([](Task& is) { is.retries = kMaxRetries; }) == Errc::ok);
  CHECK(changed([](Task& is) { is.retries = kMaxRetries + 1; }) == Errc::bad_value);
  CHECK(changed([](Task& is) { is.retry_after_s = 0; }) == Errc::bad_value);
  CHECK(changed([](Task& is) { is.retry_after_s = NAN; }) == Errc::bad_value);
  CHECK(changed([](Task& is) { is.retry_after_s = 1e9; }) == Errc::bad_value);
  CHECK(changed([](Task& is) { is.start_within_s = 60; }) == Errc::ok);
  CHECK(changed([](Task& is) { is.start_within_s = 0.01; }) == Errc::bad_value);
  CHECK(changed([](Task& is) { is.start_within_s = -1; }) == Errc::bad_value);
  CHECK(changed([](Task& is) { is.start_within_s = NAN; }) == Errc::bad_value);
  CHECK(changed([](Task& is) { is.start_within_s = 1e9; }) == Errc::bad_value);
  CHECK(changed([](Task& is) { is.values = {{"p", "a", ""}, {"q", "a", "x"}}; }) == Errc::ok);
  CHECK(changed([](Task& is) { is.values = {{"p", "a", ""}, {"p", "a", "x"}}; }) == Errc::duplicate);
  CHECK(changed([](Task& is) { is.values = {{"p", "b", ""}}; }) == Errc::bad_value);
}

TEST_CASE("a join is ready once all its predecessors are final") {
  const Scenario scenario = diamond();
  CHECK(predecessors_final(scenario.tasks[0], {false, false, false, false}));
  CHECK_FALSE(predecessors_final(scenario.tasks[1], {false, false, false, false}));
  CHECK(predecessors_final(scenario.tasks[1], {true, false, false, false}));
  CHECK_FALSE(predecessors_final(scenario.tasks[3], {true, true, false, false}));
  CHECK_FALSE(predecessors_final(scenario.tasks[3], {true, false, true, false}));
  CHECK(predecessors_final(scenario.tasks[3], {true, true, true, false}));
  CHECK(successors_of(scenario)[0] == std::vector<TaskIndex>{1, 2});
  CHECK(successors_of(scenario)[3].empty());
}

TEST_CASE("a bitmap goes there and back, and refuses bits beyond the last task") {
  std::vector<bool> bits(9, false);
  bits[0] = bits[7] = bits[8] = true;
  CHECK(to_bitmap(bits) == std::string("\x81\x01", 2));
  CHECK(*from_bitmap(to_bitmap(bits), 9) == bits);
  bits[8] = false;
  bits.resize(1000);
  CHECK(to_bitmap(bits) == "\x81");
  CHECK(*from_bitmap(to_bitmap(bits), 1000) == bits);
  CHECK(to_bitmap(std::vector<bool>(1000)).empty());
  CHECK(*from_bitmap("", 2) == std::vector<bool>{false, false});
  CHECK(from_bitmap("\x04", 2).error().code == Errc::too_large);
  CHECK(from_bitmap(std::string(2, '\0'), 2).ok());
}

TEST_CASE("Equation 8 gives the paper's seven forward messages for twelve tasks in three blocks") {
  const std::vector<std::string> robots{"a", "b", "b", "c", "d", "d", "d", "a", "b", "c", "c", "a"};
  CHECK(blocks_of(robots) == Blocks{3, 7});
  CHECK(forward_messages(robots) == 7);
  CHECK(forward_messages({"a", "a"}) == 0);
  CHECK(forward_messages({"a"}) == 0);
  CHECK(forward_messages({}) == 0);
}
