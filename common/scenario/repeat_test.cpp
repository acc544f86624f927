// Random graphs, repeated: what must hold for every one of them.
#include "common/scenario/repeat.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <set>

#include "common/scenario/graph.hpp"

using namespace trb;

namespace {

using Random = std::mt19937;

std::size_t below(Random& random, std::size_t count) {
  return random() % count;
}

/// Up to `most` tasks, each with up to four predecessors out of any that stand before it in a random order.
Scenario random_graph(Random& random, std::size_t most) {
  Scenario out;
  out.tasks.resize(1 + below(random, most));
  std::vector<TaskIndex> order(out.tasks.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<TaskIndex>(i);
  std::shuffle(order.begin(), order.end(), random);
  for (std::size_t i = 0; i < order.size(); ++i) {
    Task& task = out.tasks[order[i]];
    task.id = "t" + std::to_string(order[i]);
    task.robot = "r" + std::to_string(below(random, 5));
    std::set<TaskIndex> after;
    for (std::size_t k = below(random, 5); k > 0 && i > 0; --k) after.insert(order[below(random, i)]);
    task.after.assign(after.begin(), after.end());
    for (const TaskIndex before : task.after) {
      if (below(random, 3) == 0) {
        task.values.push_back({"p" + std::to_string(before), "t" + std::to_string(before), ""});
      }
    }
  }
  return out;
}

std::vector<TaskIndex> ready_tasks(const Scenario& scenario, const std::vector<bool>& done) {
  std::vector<TaskIndex> out;
  for (std::size_t i = 0; i < scenario.tasks.size(); ++i) {
    if (!done[i] && predecessors_final(scenario.tasks[i], done)) out.push_back(static_cast<TaskIndex>(i));
  }
  return out;
}

/// A number for each task in an order in which they may run; no task comes before one that it waits for.
std::vector<std::size_t> places_in(const Scenario& scenario) {
  std::vector<std::size_t> out(scenario.tasks.size(), 0);
  std::vector<bool> done(scenario.tasks.size(), false);
  std::size_t next = 0;
  for (auto ready = ready_tasks(scenario, done); !ready.empty(); ready = ready_tasks(scenario, done)) {
    for (const TaskIndex task : ready) {
      done[task] = true;
      out[task] = next;
    }
    ++next;
  }
  CHECK(std::ranges::count(done, true) == static_cast<std::ptrdiff_t>(done.size()));
  return out;
}

/// A round's task with the round removed.
Task without_round(Task task, std::size_t shift) {
  const auto bare = [](const std::string& id) { return id.substr(0, id.find('#')); };
  task.id = bare(task.id);
  for (ValueFrom& value : task.values) value.task = bare(value.task);
  for (TaskIndex& before : task.after) before = static_cast<TaskIndex>(before - shift);
  return task;
}

}  // namespace

TEST_CASE("whatever the graph, its rounds are a graph, follow each other, and say the same") {
  Random random(20250101);
  for (int story = 0; story < 60; ++story) {
    CAPTURE(story);
    const Scenario once = random_graph(random, 200);
    REQUIRE(check_graph(once).ok());
    const std::size_t tasks = once.tasks.size();
    const auto rounds = static_cast<std::uint32_t>(1 + below(random, std::min<std::size_t>(kMaxTasks / tasks, 12)));
    Scenario all = once;
    all.tasks = repeat_tasks(once.tasks, rounds);

    REQUIRE(all.tasks.size() == tasks * rounds);
    REQUIRE(check_graph(all).ok());  // acyclic, ids unique and valid, values of predecessors
    const std::vector<std::size_t> places = places_in(all);
    for (std::size_t i = 0; i < all.tasks.size(); ++i) {
      const Task& task = all.tasks[i];
      const std::size_t round = i / tasks;
      CHECK(task.id == round_id(once.tasks[i % tasks].id, static_cast<std::uint32_t>(round + 1)));
      CHECK(is_repetition(task.id) == (round > 0));
      Task bare = without_round(task, round * tasks);
      if (once.tasks[i % tasks].after.empty()) bare.after.clear();
      CHECK(bare == once.tasks[i % tasks]);
    }
    for (std::uint32_t round = 1; round < rounds; ++round) {
      const auto begin = places.begin() + static_cast<std::ptrdiff_t>(round * tasks);
      const auto count = static_cast<std::ptrdiff_t>(tasks);
      CHECK(*std::max_element(begin - count, begin) < *std::min_element(begin, begin + count));
    }
  }
}
