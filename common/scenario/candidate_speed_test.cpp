#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <string>
#include <vector>

#include "common/scenario/candidate_index.hpp"
#include "common/scenario/definition.hpp"
#include "common/scenario/task_need.hpp"
#include "common/scenario/test/candidate_hall.hpp"

using namespace trb;

namespace {

/// A thousand robots that all have the skill.
Profiles large_hall() {
  Profiles out;
  for (int i = 0; i < 1000; ++i) {
    NodeProfile profile = i % 2 == 0 ? carrier() : cart();
    for (int k = 0; k < 60; ++k) profile.places.push_back("place" + std::to_string(k));
    for (int k = 0; k < 10; ++k) profile.skills.push_back({"skill" + std::to_string(k), "mobile", {}, true, 60});
    out["robot" + std::to_string(i)] = profile;
  }
  return out;
}

/// The least of five, in milliseconds of this process: other processes may use the machine meanwhile.
template <class Work>
double cpu_ms(Work work) {
  double least = 1e9;
  for (int i = 0; i < 5; ++i) {
    const std::clock_t begin = std::clock();
    work();
    least = std::min(least, 1000.0 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  return least;
}

}  // namespace

TEST_CASE(
    "a thousand robots: check, preflight and binding of a hundred tasks take no more than a few looks at each robot") {
  const Profiles profiles = large_hall();
  Scenario scenario{"n", "", {}};
  for (int i = 0; i < 100; ++i) {
    // Every second task requires something that no robot has, which takes a look at each robot.
    const std::string place = i % 2 == 0 ? "place" + std::to_string(i % 60) : "nowhere" + std::to_string(i);
    Task task = late({"mobile"}, "go_to", R"({"place":")" + place + "\"}");
    task.id = "t" + std::to_string(i);
    scenario.tasks.push_back(task);
  }
  // The floor: each task is compared with each robot once. A slow machine is slow at both.
  std::vector<TaskNeed> needs;
  for (const Task& task : scenario.tasks) needs.push_back(need_of(task).value());
  std::size_t taken = 0;
  const double floor = cpu_ms([&] {
    for (const TaskNeed& need : needs) {
      for (const auto& [id, profile] : profiles) taken += takes_task(need, profile) ? 1U : 0U;
    }
  });
  REQUIRE(taken > 0);
  const double ms = cpu_ms([&] {
    ConfigFaults faults;
    check_scenario(scenario, profiles, "s.json", faults);
    CHECK(faults.size() == 50);
    CandidateIndex candidates(profiles);
    CHECK(tasks_without_spare(scenario, candidates).size() == 50);
    CHECK(bind_tasks(scenario, candidates, "", "s.json", faults)[0] == "robot0");
  });
  MESSAGE("check, preflight, binding: " << ms << " ms, " << ms / floor << " of the floor's " << floor << " ms");
  CHECK(ms / floor < 4);
}
