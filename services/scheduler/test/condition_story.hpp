// What the stories of conditional tasks share: the paper's task 6, and a fleet that runs it.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/scenario/test/make_task.hpp"
#include "services/scheduler/test/fleet.hpp"

namespace trb::scheduler::test {

inline Task task(const char* id, const char* robot, std::vector<TaskIndex> after) {
  return make_task(id, robot, "go_to", std::move(after));
}

inline Task when(Task is, Comparison op, double degrees, const char* of = "conveyor") {
  is.when = {{"temperature", of, "", op, false, degrees, "", "degC"}};
  return is;
}

/// The paper's task 6: after `bring` (ridgeback, who so evaluates the conditions) `left` goes up to 20 degC, `right`
/// above; `back` joins them.
inline Scenario left_or_right(const char* left = "ur3", const char* right = "ur3") {
  Scenario scenario;
  scenario.name = "task 6";
  scenario.tasks = {task("bring", "ridgeback", {}), when(task("left", left, {0}), Comparison::at_most, 20),
                    when(task("right", right, {0}), Comparison::more, 20), task("back", "pioneer", {1, 2})};
  return scenario;
}

struct Story {
  explicit Story(std::uint64_t seed = 1) : fleet(seed) { add_demonstration(fleet); }

  void submit(const Scenario& scenario, const std::string& node = "cloud", Duration life = seconds(3600)) {
    fleet.ask(node, MessageType::command, RunSubmit{fleet.make_start(scenario, node, life, kRun)});
  }
  RunView view(const std::string& node = "cloud") { return fleet.view(node, kRun); }
  bool finishes(const std::string& node = "cloud") {
    return fleet.until([&] { return fleet[node].up && view(node).state == RunState::finished; });
  }
  TaskView seen(const std::string& id, const std::string& node = "cloud") {
    const RunView all = view(node);
    const auto at = std::find_if(all.tasks.begin(), all.tasks.end(), [&](const TaskView& one) { return one.id == id; });
    return at == all.tasks.end() ? TaskView{} : *at;  // the run is not known there yet
  }
  std::map<std::string, int> begun() {
    std::map<std::string, int> out;
    for (const char* robot : {"conveyor", "drone", "pioneer", "ridgeback", "ur3"}) {
      for (const auto& [key, times] : fleet[robot].adapter.begun) out[key.second.task] += times;
    }
    return out;
  }
  /// Waits until the node that evaluates says that it waits for something.
  bool waits(const std::string& for_what, const std::string& node = "cloud") {
    return fleet.until([&] { return view(node).waits_for == for_what; }, seconds(60));
  }
  void check_one_branch() {
    const auto times = begun();
    CHECK(times.count("left") + times.count("right") == 1);
    for (const auto& one : times) CHECK_MESSAGE(one.second == 1, one.first);
    CHECK(times.contains("back"));
  }
  /// The verdicts on each task over all journals: never two.
  void check_one_verdict_each() {
    std::map<std::string, std::set<bool>> verdicts;
    for (const char* node : {"cloud", "conveyor", "drone", "pioneer", "ridgeback", "ur3"}) {
      for (const JournalRecord& record : fleet[node].journal) {
        const auto* kept = get_if<JournalChoice>(&record);
        if (kept == nullptr) continue;
        const auto choice = decode<Choice>(kept->choice.payload.bytes);
        for (const ChosenTask& one : choice->tasks) verdicts[one.task].insert(one.holds);
      }
    }
    CHECK(verdicts.size() == 2);
    for (const auto& one : verdicts) CHECK_MESSAGE(one.second.size() == 1, one.first);
    CHECK(*verdicts["left"].begin() != *verdicts["right"].begin());
  }

  Fleet fleet;
};

}  // namespace trb::scheduler::test
