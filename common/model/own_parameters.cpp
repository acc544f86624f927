#include "common/model/own_parameters.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "common/scenario/graph.hpp"

namespace trb::model {
namespace {

const std::string kDecider = "cloud";

struct Spell {
  double begin_s = 0, end_s = 0;  ///< of its first and its last task
};

struct Passed {
  double at_s = 0;
  std::string to;
};

/// From when on a robot knows that it has something to do, until it has done it.
struct Work {
  double from_s = 0, end_s = 0;
};

/// How often a robot without work asks for the run's end in so long a time. A handover takes a moment more than none: a
/// question at the very end is sent.
std::uint64_t questions_in(double idle_s) {
  std::uint64_t out = 0;
  double at_s = kAsksEndAfter_s;
  for (double wait_s = 2 * kAsksEndAfter_s; at_s <= idle_s; wait_s = std::min(2 * wait_s, kAsksEndEach_s)) {
    ++out;
    at_s += wait_s;
  }
  return out;
}

/// Plays the scenario: what begins when, where batons go, whom the run controls.
class Schedule {
 public:
  Schedule(const Scenario& scenario, std::vector<std::string> robots, const std::vector<double>& task_s)
      : scenario_(scenario),
        robots_(std::move(robots)),
        task_s_(task_s),
        successors_(successors_of(scenario)),
        open_(scenario.tasks.size()),
        ready_s_(scenario.tasks.size(), 0) {
    for (std::size_t i = 0; i < open_.size(); ++i) {
      open_[i] = scenario.tasks[i].after.size();
      if (open_[i] == 0) ready_.insert(static_cast<TaskIndex>(i));
    }
  }

  void play() {
    pass_first();
    while (!ready_.empty()) play(next());
  }

  [[nodiscard]] std::uint64_t batons() const { return passed_.size() + to_decider_; }
  [[nodiscard]] std::uint64_t twice() const {
    std::map<std::string, double> first;
    std::uint64_t out = 0;
    for (const auto& [at_s, to] : passed_) {
      const auto [of, is_first] = first.emplace(to, at_s);
      out += !is_first && of->second == at_s ? 1U : 0U;
    }
    return out;
  }
  [[nodiscard]] std::uint64_t resumed() const { return resumed_; }
  [[nodiscard]] double end_s() const { return end_s_; }
  [[nodiscard]] std::uint64_t spells() const {
    std::uint64_t out = 0;
    for (const auto& [robot, spells] : spells_) out += spells.size();
    return out;
  }
  /// A robot's own tasks are all done, and the run is not over. That it will be given one that names none it does not
  /// know before.
  [[nodiscard]] std::uint64_t end_asked() const {
    std::uint64_t out = 0;
    for (auto [robot, works] : works_) {
      std::ranges::sort(works, {}, &Work::from_s);
      double free_s = works.front().from_s;
      for (const Work& work : works) {
        if (work.from_s > free_s) out += questions_in(work.from_s - free_s);
        free_s = std::max(free_s, work.end_s);
      }
      if (free_s < end_s_) out += questions_in(end_s_ - free_s);
    }
    return out;
  }
  /// Batons that reach a robot under control.
  [[nodiscard]] std::uint64_t kept() const {
    return static_cast<std::uint64_t>(std::ranges::count_if(passed_, [&](const Passed& one) {
      return std::ranges::any_of(spells_.at(one.to), [&](const Spell& spell) {
        return spell.begin_s < one.at_s && one.at_s < spell.end_s + kControl_s;
      });
    }));
  }

 private:
  [[nodiscard]] double begin_of(TaskIndex task) const {
    const auto free = free_s_.find(robots_[task]);
    return std::max(ready_s_[task], free == free_s_.end() ? 0 : free->second);
  }
  [[nodiscard]] TaskIndex next() const {
    return *std::ranges::min_element(ready_, {}, [&](TaskIndex task) { return begin_of(task); });
  }

  void pass_first() {
    std::set<std::string> to;
    for (const TaskIndex task : ready_) {
      if (!is_late(task)) to.insert(robots_[task]);  // the cloud itself has the others
    }
    for (const std::string& robot : to) passed_.push_back({0, robot});
  }

  void play(TaskIndex task) {
    ready_.erase(task);
    const double begin = begin_of(task), end = begin + task_s_[task];
    control(robots_[task], begin, end);
    // One that names it, it knows from the start.
    works_[robots_[task]].push_back({is_late(task) ? ready_s_[task] : 0, end});
    free_s_[robots_[task]] = end;
    end_s_ = std::max(end_s_, end);
    std::set<std::string> to;
    for (const TaskIndex after : successors_[task]) {
      const std::string& actor = is_late(after) ? kDecider : actor_before(after);
      if (actor != robots_[task] && is_last_of(robots_[task], after)) to.insert(actor);
      ready_s_[after] = std::max(ready_s_[after], end);
      if (--open_[after] == 0) make_ready(after);
    }
    done_.insert(task);
    for (const std::string& robot : to) pass(end, robot);
  }

  void pass(double at_s, const std::string& robot) {
    robot == kDecider ? void(++to_decider_) : passed_.push_back({at_s, robot});
  }

  /// Nobody is named: the cloud chooses once it is due.
  [[nodiscard]] bool is_late(TaskIndex task) const { return scenario_.tasks[task].robot.empty(); }

  /// Who gets the batons of its predecessors: who evaluates its condition, if it has one.
  [[nodiscard]] const std::string& actor_before(TaskIndex task) const {
    const bool is_conditional = !scenario_.tasks[task].when.empty();
    return robots_[is_conditional ? chooser_of(scenario_, task) : task];
  }

  /// Its condition has been evaluated: now its robot gets the baton.
  void make_ready(TaskIndex task) {
    ready_.insert(task);
    if (is_late(task)) return pass_on_decision(task);
    if (actor_before(task) != robots_[task]) passed_.push_back({ready_s_[task], robots_[task]});
  }

  /// Whoever has done what comes before it learns who does it, and passes it on.
  void pass_on_decision(TaskIndex task) {
    std::set<std::string> givers;
    for (const TaskIndex before : scenario_.tasks[task].after) givers.insert(robots_[before]);
    givers.erase(robots_[task]);
    for (std::size_t i = 0; i < givers.size(); ++i) pass(ready_s_[task], robots_[task]);
  }

  /// No other task of this robot has to come before that one: now it passes it on.
  [[nodiscard]] bool is_last_of(const std::string& robot, TaskIndex task) const {
    const auto& before = scenario_.tasks[task].after;
    const auto open =
        std::ranges::count_if(before, [&](TaskIndex one) { return robots_[one] == robot && !done_.contains(one); });
    return open == 1;
  }

  void control(const std::string& robot, double begin, double end) {
    std::vector<Spell>& spells = spells_[robot];
    if (spells.empty() || begin >= spells.back().end_s + kControl_s) return spells.push_back({begin, end});
    if (begin > spells.back().end_s) ++resumed_;
    spells.back().end_s = end;
  }

  const Scenario& scenario_;
  std::vector<std::string> robots_;
  const std::vector<double>& task_s_;
  std::vector<std::vector<TaskIndex>> successors_;
  std::vector<std::size_t> open_;
  std::vector<double> ready_s_;
  std::set<TaskIndex> ready_, done_;
  std::map<std::string, double> free_s_;
  std::map<std::string, std::vector<Spell>> spells_;
  std::map<std::string, std::vector<Work>> works_;  ///< by robot
  std::vector<Passed> passed_;
  std::uint64_t to_decider_ = 0;
  std::uint64_t resumed_ = 0;
  double end_s_ = 0;
};

std::vector<std::string> robots_of(const Scenario& scenario, const std::vector<std::string>& assigned) {
  std::vector<std::string> out = assigned;
  out.resize(scenario.tasks.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Task& task = scenario.tasks[i];
    if (!task.robot.empty()) out[i] = task.robot;
    if (out[i].empty()) out[i] = "? of " + task.id;
  }
  return out;
}

std::uint64_t remote_requests(const Scenario& scenario, const std::vector<std::string>& robots) {
  std::uint64_t out = 0;
  for (TaskIndex i = 0; i < scenario.tasks.size(); ++i) {
    for (const Condition& condition : scenario.tasks[i].when) {
      out += condition.of == robots[chooser_of(scenario, i)] ? 0U : 1U;
    }
  }
  return out;
}

}  // namespace

Scenario tasks_in_turn(std::size_t robots, std::size_t tasks) {
  Scenario out;
  out.name = "in turn";
  for (std::size_t i = 0; i < tasks; ++i) {
    Task task;
    task.id = "t" + std::to_string(i);
    task.robot = "r" + std::to_string(i % robots);
    if (i > 0) task.after = {static_cast<TaskIndex>(i - 1)};
    out.tasks.push_back(std::move(task));
  }
  return out;
}

OwnParameters own_parameters_of(const Scenario& scenario, const std::vector<std::string>& assigned,
                                const std::vector<double>& task_s) {
  const std::vector<std::string> robots = robots_of(scenario, assigned);
  const std::set<std::string> at_work(robots.begin(), robots.end());
  Schedule schedule(scenario, robots, task_s);
  schedule.play();
  OwnParameters p;
  p.robots = std::max<std::size_t>(at_work.size(), 1);
  p.tasks = scenario.tasks.size();
  p.members = at_work.size();
  p.batons = schedule.batons();
  p.spells = schedule.spells();
  p.kept = schedule.kept();
  p.twice = schedule.twice();
  p.resumed = schedule.resumed();
  p.end_asked = schedule.end_asked();
  p.remote_requests = remote_requests(scenario, robots);
  p.bound = static_cast<std::uint64_t>(
      std::ranges::count_if(scenario.tasks, [](const Task& task) { return task.robot.empty(); }));
  p.seconds = schedule.end_s() + kControl_s;
  return p;
}

OwnParameters own_parameters_of(const Scenario& scenario, const std::vector<std::string>& assigned, double task_s) {
  return own_parameters_of(scenario, assigned, std::vector<double>(scenario.tasks.size(), task_s));
}

std::vector<double> task_times(const Scenario& scenario, const std::map<std::string, double>& times, double usual) {
  std::vector<double> out;
  for (const Task& task : scenario.tasks) {
    const auto of_task = times.find("task:" + task.id);
    const auto own = of_task == times.end() ? times.find(task.skill) : of_task;
    out.push_back(own == times.end() ? usual : own->second);
  }
  return out;
}

}  // namespace trb::model
