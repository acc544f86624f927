#include "services/scheduler/test/random_world.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>

#include "common/scenario/repeat.hpp"

namespace trb::scheduler::test {
namespace {

constexpr std::size_t kLargest = 200;

class Maker {
 public:
  explicit Maker(std::uint64_t seed) : dice_(seed) {}

  World make() {
    calm_ = dice_.percent(60);
    for (std::uint64_t i = 0, count = dice_.from(1, dice_.percent(30) ? 12 : 4); i <= count - 1; ++i) {
      world_.robots.push_back("r" + std::to_string(i + 1));
    }
    world_.has_cloud = !dice_.percent(10);
    const bool by_robot = !world_.has_cloud || dice_.percent(30);
    world_.submitter = by_robot ? dice_.one_of(world_.robots) : "cloud";
    world_.decides = !calm_ && world_.submitter == "cloud" && dice_.percent(60);
    make_sensors();
    make_tasks();
    for (const Task& task : world_.scenario.tasks) make_fate(task);
    make_circumstances();
    return std::move(world_);
  }

 private:
  void make_sensors() {
    for (std::uint64_t i = 0; i < 4; ++i) {
      Sense sense;
      sense.node = world_.has_cloud && dice_.percent(20) ? "cloud" : dice_.one_of(world_.robots);
      sense.identity = dice_.percent(30) ? "28-0" + std::to_string(i) : "";
      sense.is_text = i == 3;
      sense.number = static_cast<double>(dice_.below(5));
      sense.text = dice_.percent(50) ? "04a1" : "04a2";
      sense.bad_before = dice_.percent(30) ? dice_.from(1, 2) : 0;
      world_.senses["sensor-" + std::to_string(i)] = sense;
    }
  }

  Condition make_condition() {
    const auto& [name, sense] = *std::next(world_.senses.begin(), static_cast<std::ptrdiff_t>(dice_.below(4)));
    Condition out;
    out.sensor = name;
    if (dice_.percent(50)) out.of = sense.node;
    if (dice_.percent(50)) out.identity = sense.identity;
    out.is_text = sense.is_text;
    out.op = static_cast<Comparison>(sense.is_text ? dice_.from(4, 5) : dice_.below(6));
    out.number = sense.is_text ? 0 : static_cast<double>(dice_.below(5));
    out.text = sense.is_text ? "04a1" : "";
    out.unit = sense.is_text ? "" : "degC";
    return out;
  }

  /// Some of the tasks before: mostly late ones, so that there are long ways, forks and joins.
  std::vector<TaskIndex> make_after(std::size_t index) {
    std::vector<TaskIndex> out;
    if (index == 0 || dice_.percent(12)) return out;
    const std::uint64_t count = dice_.percent(60) ? 1 : dice_.from(2, 5);
    const std::uint64_t near = dice_.percent(80) ? std::min<std::uint64_t>(index, 6) : index;
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto before = static_cast<TaskIndex>(index - 1 - dice_.below(near));
      if (std::find(out.begin(), out.end(), before) == out.end()) out.push_back(before);
    }
    return out;
  }

  void make_tasks() {
    const std::uint64_t size = dice_.below(100);
    const std::size_t count =
        size < 4 ? dice_.from(40, kLargest) : (size < 25 ? dice_.from(13, 40) : dice_.from(1, 12));
    std::vector<Task> tasks(count);
    for (std::size_t i = 0; i < count; ++i) make_task(tasks, i);
    shuffle(tasks);
    world_.scenario.name = "random";
    world_.scenario.tasks = tasks;
    const std::size_t rounds = dice_.percent(10) ? std::min<std::size_t>(dice_.from(2, 3), kLargest / count) : 1;
    if (rounds > 1) world_.scenario.tasks = repeat_tasks(tasks, static_cast<std::uint32_t>(rounds));
  }

  void make_task(std::vector<Task>& tasks, std::size_t index) {
    Task& task = tasks[index];
    task.id = "t" + std::to_string(index);
    task.robot = dice_.one_of(world_.robots);
    task.skill = "do";
    task.data = dice_.percent(50) ? R"({"base":7})" : "";
    task.after = make_after(index);
    if (dice_.percent(15)) task.when.push_back(make_condition());
    const bool other_branch = index > 0 && !tasks[index - 1].when.empty() && dice_.percent(60);
    if (other_branch) make_alternative(task, tasks[index - 1]);
    task.retries = dice_.percent(40) ? static_cast<std::uint32_t>(dice_.from(1, 3)) : 0;
    task.retry_after_s = 0.1 * static_cast<double>(dice_.from(1, 20));
    task.pinned = dice_.percent(10);
    make_values(task, tasks);
    const bool late = world_.decides && tasks.size() <= 40 && dice_.percent(15);
    if (late) task.robot.clear();
    if (late) task.requires_ = {"hands"};
    const bool must_skip = calm_ && !task.values.empty();
    if (must_skip || dice_.percent(50)) task.on_failure = dice_.percent(40) ? OnFailure::continue_ : OnFailure::skip;
    if (!calm_ && dice_.percent(15)) task.on_failure = OnFailure::abort;
  }

  /// The same as the task before, on the opposite condition.
  static void make_alternative(Task& task, const Task& other) {
    constexpr Comparison kOpposite[] = {Comparison::at_least, Comparison::more,    Comparison::at_most,
                                        Comparison::less,     Comparison::unequal, Comparison::equal};
    task.after = other.after;
    task.when = other.when;
    task.when[0].op = kOpposite[static_cast<std::size_t>(task.when[0].op)];
  }

  void make_values(Task& task, const std::vector<Task>& tasks) {
    if (task.after.empty() || !dice_.percent(35)) return;
    for (std::uint64_t i = 0, count = dice_.from(1, 3); i < count; ++i) {
      const std::string name = dice_.percent(5) ? "missing" : (dice_.percent(60) ? "n" : "");
      task.values.push_back({"p" + std::to_string(i), tasks[dice_.one_of(task.after)].id, name});
    }
  }

  /// A file may name its tasks in any order, and who evaluates a condition hangs on it.
  void shuffle(std::vector<Task>& tasks) {
    std::vector<TaskIndex> place(tasks.size());
    std::iota(place.begin(), place.end(), TaskIndex{0});
    for (std::size_t i = place.size(); i > 1; --i) std::swap(place[i - 1], place[dice_.below(i)]);
    std::vector<Task> out(tasks.size());
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      for (TaskIndex& before : tasks[i].after) before = place[before];
      out[place[i]] = std::move(tasks[i]);
    }
    tasks = std::move(out);
  }

  void make_fate(const Task& task) {
    world_.tellings[task.id] = dice_.percent(15)   ? Telling::nothing
                               : dice_.percent(20) ? Telling::plain
                                                   : Telling::named;
    const bool skips = task.on_failure == OnFailure::skip || task.on_failure == OnFailure::continue_;
    const bool may_fail = !calm_ || skips;
    std::vector<TaskOutcome>& out = world_.endings[task.id];
    const std::uint64_t fails = dice_.percent(25) ? dice_.from(1, 4) : 0;
    for (std::uint64_t i = 0; i < fails && (may_fail || i < task.retries); ++i) {
      const bool again = i < task.retries && dice_.percent(30);
      out.push_back(again ? TaskOutcome::retriable : TaskOutcome::failed);
    }
    out.push_back(may_fail && dice_.percent(8) ? TaskOutcome::failed : TaskOutcome::finished);
    if (!calm_ && dice_.percent(3)) out.back() = TaskOutcome::interrupted;
    if (!calm_ && dice_.percent(3)) out.back() = TaskOutcome::retriable;
    if (task.robot.empty()) world_.bindings[task.id] = dice_.percent(20) ? "spare" : dice_.one_of(world_.robots);
    for (std::uint64_t i = 0, times = dice_.below(3); i < times; ++i) {
      const auto ruling = static_cast<Ruling>(dice_.below(3));
      world_.rulings[task.id].push_back(task.pinned && ruling == Ruling::move ? Ruling::retry : ruling);
    }
  }

  void make_circumstances() {
    if (dice_.percent(70)) {
      const auto upto = [&](std::uint64_t most) { return static_cast<unsigned>(dice_.below(most)); };
      world_.weather = {upto(200), upto(300), upto(80), seconds(0.01 * static_cast<double>(dice_.below(150)))};
    }
    world_.skill_times["spare"] = seconds(0.5);
    if (world_.has_cloud && dice_.percent(8)) world_.crashes["cloud"] = dice_.from(2, 20);
    for (const std::string& robot : world_.robots) {
      world_.skill_times[robot] = seconds(0.01 * static_cast<double>(dice_.from(1, 300)));
      if (dice_.percent(8)) world_.crashes[robot] = dice_.from(1, 12);
    }
    world_.crash_after_sends = dice_.percent(50);
    world_.repeatable = dice_.percent(50);
  }

  Dice dice_;
  World world_;
  bool calm_ = false;
};

}  // namespace

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

TaskOutcome World::ending(const AttemptKey& key) const {
  const auto& all = endings.at(key.task);
  return all[std::min<std::size_t>(key.attempt, all.size()) - 1];
}

std::string World::told(const AttemptKey& key, const std::string& data) const {
  std::uint64_t hash = key.attempt;
  for (const char c : key.task + "/" + data) hash = hash * 131 + static_cast<unsigned char>(c);
  const std::string number = std::to_string(hash % 1000);
  switch (tellings.at(key.task)) {
    case Telling::nothing:
      return "";
    case Telling::plain:
      return number;
    case Telling::named:
      break;
  }
  return R"({"n":)" + number + "}";
}

TaskRuling World::ruling(const std::string& task, std::size_t times, const std::string& robot,
                         std::uint32_t next_attempt) const {
  if (robot.empty()) return {task, Ruling::move, bindings.at(task), next_attempt, Evidence::result};
  const auto own = rulings.find(task);
  const bool none = own == rulings.end() || times >= own->second.size();
  TaskRuling out{task, none ? Ruling::skip : own->second[times], robot, next_attempt, Evidence::result};
  if (out.ruling == Ruling::skip) out.robot = "cloud";
  if (out.ruling == Ruling::move) {
    const auto at = std::find(robots.begin(), robots.end(), robot);
    out.robot = at == robots.end() ? robots.front() : (at + 1 == robots.end() ? "spare" : *(at + 1));
  }
  return out;
}

World random_world(std::uint64_t seed) {
  return Maker(seed).make();
}

}  // namespace trb::scheduler::test
