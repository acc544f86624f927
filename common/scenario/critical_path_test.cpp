#include "common/scenario/critical_path.hpp"

#include <doctest/doctest.h>

using namespace trb;

namespace {

std::string critical(const std::vector<PlayedTask>& tasks) {
  const auto waits = waits_of(tasks);
  std::string out;
  for (std::size_t i = 0; i < tasks.size(); ++i) out += waits[i].is_critical ? tasks[i].id + " " : "";
  return out;
}

}  // namespace

TEST_CASE("a task waits for the last of its predecessors, and that one is on the critical path") {
  const std::vector<PlayedTask> tasks{{"fetch", "cart", 0, 3, {}},
                                      {"heat", "oven", 0, 10, {}},
                                      {"join", "arm", 10.1, 12, {"fetch", "heat"}},
                                      {"tidy", "cart", 3.1, 5, {"fetch"}}};
  const auto waits = waits_of(tasks);
  CHECK_FALSE(waits[0].holder);
  CHECK(waits[2].holder == 1);
  CHECK_FALSE(waits[2].is_robot_busy);
  CHECK(waits[3].holder == 0);
  CHECK(critical(tasks) == "heat join ");
}

TEST_CASE("a robot that is busy holds up what comes next to it") {
  const std::vector<PlayedTask> tasks{
      {"a", "cart", 0, 5, {}}, {"b", "arm", 0, 1, {}}, {"c", "cart", 5.2, 6, {"b"}}, {"d", "arm", 6.1, 7, {"c"}}};
  const auto waits = waits_of(tasks);
  CHECK(waits[2].holder == 0);
  CHECK(waits[2].is_robot_busy);
  CHECK(waits[3].holder == 2);
  CHECK_FALSE(waits[3].is_robot_busy);
  CHECK(critical(tasks) == "a c d ");
}

TEST_CASE("a predecessor that is not known held nothing up; no tasks have no path; a repeated id ends no loop") {
  CHECK(waits_of({}).empty());
  const auto waits = waits_of({{"a", "cart", 0, 5, {"gone"}}});
  CHECK_FALSE(waits[0].holder);
  CHECK(waits[0].is_critical);
  CHECK(waits_of({{"a", "x", 0, 1, {"a"}}, {"a", "x", 1, 2, {"a"}}}).size() == 2);
}

TEST_CASE("an attempt waits for the one of its task that failed before it; what has no end ends no path") {
  std::vector<PlayedTask> tasks{{"b", "old", 0, 8, {}, true},
                                {"a", "cart", 0, 5, {}},
                                {"b", "cart", 8.1, 18, {}},
                                {"c", "arm", 18.1, 1e9, {"b"}}};
  tasks[3].is_open = true;
  const auto waits = waits_of(tasks);
  CHECK_FALSE(waits[0].holder);
  CHECK(waits[2].holder == 0);
  CHECK_FALSE(waits[2].is_robot_busy);
  CHECK(waits[3].holder == 2);
  CHECK(critical(tasks) == "b b ");
}

TEST_CASE("a long gap behind the last end is a wait of its own, and the critical path begins behind it") {
  // c's result is behind a cut link until 60 s: that a and b were shorter would change nothing.
  const std::vector<PlayedTask> tasks{{"a", "ur3", 0, 10, {}},
                                      {"c", "pioneer", 0, 3, {}},
                                      {"b", "ur3", 10.1, 20, {"a"}},
                                      {"d", "ur3", 63, 65, {"b", "c"}},
                                      {"e", "pioneer", 65.1, 67, {"d"}}};
  const auto waits = waits_of(tasks);
  CHECK(waits[0].more_s == 0);
  CHECK(waits[2].more_s == doctest::Approx(0.1));
  CHECK(waits[3].holder == 2);
  CHECK(waits[3].more_s == 43);
  CHECK(critical(tasks) == "d e ");
}

TEST_CASE("a task without anything before it that begins late has waited since the beginning") {
  const auto waits = waits_of({{"a", "cart", 0, 5, {}}, {"b", "arm", 30, 31, {}}});
  CHECK_FALSE(waits[1].holder);
  CHECK(waits[1].more_s == 30);
  CHECK(waits[1].is_critical);
  CHECK_FALSE(waits[0].is_critical);
}
