// Random graphs: real schedulers that pass batons in any weather end as a plain sequential interpreter says.
//   TRB_SEED=N the first graph's seed (1)   TRB_GRAPHS=N how many (1000)
#include <doctest/doctest.h>

#include <algorithm>

#include "common/scenario/run_start.hpp"
#include "services/scheduler/test/sequential.hpp"

using namespace trb;
using namespace trb::scheduler::test;

namespace {

/// The run of a world, as its robots had it.
class Played {
 public:
  explicit Played(std::uint64_t seed) : world(random_world(seed)), fleet(seed) {
    if (world.has_cloud) fleet.add("cloud", Role::cloud);
    hands_ = world.robots;
    if (world.decides) hands_.emplace_back("spare");
    for (const std::string& robot : hands_) {
      FakeAdapter& adapter = fleet.add(robot, Role::robot).adapter;
      adapter.skill_time = world.skill_times.at(robot);
      adapter.skills = {{"do", "hands", world.repeatable}};
      adapter.world = [this](const Execute& what) {
        return std::pair(world.ending(what.key), world.told(what.key, what.data));
      };
    }
    for (const auto& [name, sense] : world.senses) plug(name, sense);
    for (const auto& [robot, commit] : world.crashes) {
      fleet[robot].crash.at = commit;
      fleet[robot].crash.after_sends = world.crash_after_sends;
    }
    fleet.weather = world.weather;
    observer = world.has_cloud ? "cloud" : world.submitter;
    fleet.ask(world.submitter, MessageType::command, RunSubmit{start()});
    pass_until_quiet();
    for (const std::string& robot : hands_) {
      for (const auto& [key, data] : fleet[robot].adapter.given) given[key.task][key.attempt] = {robot, data};
      for (const auto& [key, times] : fleet[robot].adapter.begun) begun_once = begun_once && times == 1;
    }
  }

  World world;
  Fleet fleet;
  std::string observer;
  RunView view;
  std::map<std::string, std::map<std::uint32_t, Command>> given;
  bool begun_once = true;

 private:
  SignedRecord start() const {
    std::vector<Member> members = fleet.members();
    std::erase_if(members, [](const Member& member) { return member.id == "spare"; });
    const UtcTime now = fleet.now().utc;
    std::vector<std::string> robots;
    for (const Task& task : world.scenario.tasks) robots.push_back(task.robot.empty() ? "cloud" : task.robot);
    const RunStart start =
        build_run_start(world.scenario, members, world.submitter, now, now + seconds(1e6), kRun, std::move(robots));
    return fleet.sign(world.submitter, kSignedRunStart, encode(start));
  }

  void plug(const std::string& name, const Sense& sense) {
    FakeSensor& sensor = fleet[sense.node].sensors.plug(name, {sense.number}, sense.identity);
    if (sense.is_text) sensor.values[0] = {name, sense.identity, "", true, 0, sense.text, 1, 0, "good", 0, 0};
    SensorReading bad = sensor.values[0];
    bad.quality = "stale";
    sensor.values.insert(sensor.values.begin(), sense.bad_before, bad);
  }

  std::size_t journaled() {
    std::size_t out = 0;
    for (const Member& member : fleet.members()) out += fleet[member.id].journal.size();
    return out;
  }

  /// Until the run is over, or for two minutes nobody has journaled anything.
  void pass_until_quiet() {
    std::size_t before = 0;
    for (int quiet = 0; quiet < 8;) {
      fleet.pass(seconds(15));
      quiet = before == journaled() ? quiet + 1 : 0;
      before = journaled();
      if (!fleet[observer].up) continue;
      view = fleet.view(observer, kRun);
      if (view.state == RunState::finished) return;
      if (world.decides && view.state == RunState::paused) decide();
    }
  }

  /// On all that stands, as trb-resilience would.
  void decide() {
    const auto answers =
        sent<Definition>(fleet.tell("cloud", "cloud", MessageType::request, NeedDefinition{kRun, {}}, 0));
    const Definition& known = answers.at(0);
    Decision decision;
    decision.run = kRun;
    decision.digest = decode<RunStart>(known.start.payload.bytes)->digest;
    decision.epoch = view.epoch + 1;
    if (!known.decisions.empty()) decision.previous.bytes = digest(known.decisions.back().payload.bytes);
    decision.by = "cloud";
    bool needs_spare = false;
    for (const TaskView& is : view.tasks) {
      const bool stands = is.state == TaskState::failed || is.state == TaskState::retriable;
      const Task& task = world.scenario.tasks[static_cast<std::size_t>(&is - view.tasks.data())];
      const bool ends = task.on_failure == OnFailure::abort && is.outcome != TaskOutcome::retriable;
      if (ends && is.outcome != TaskOutcome::released) continue;  // its run is being aborted
      if (!stands && is.outcome != TaskOutcome::released) continue;
      decision.tasks.push_back(world.ruling(is.id, stood(is), is.robot, is.attempt + 1));
      needs_spare = needs_spare || decision.tasks.back().robot == "spare";
    }
    if (needs_spare && !has_spare()) decision.members = {fleet.member("spare")};
    fleet.ask("cloud", MessageType::command, RunDecision{fleet.sign("cloud", kSignedDecision, encode(decision))});
  }

  [[nodiscard]] std::size_t count_rulings(const std::function<bool(const TaskRuling&)>& such) const {
    std::size_t out = 0;
    for (const DecisionView& decision : view.decisions) {
      out += static_cast<std::size_t>(std::count_if(decision.tasks.begin(), decision.tasks.end(), such));
    }
    return out;
  }
  [[nodiscard]] std::size_t stood(const TaskView& task) const {
    const auto rulings = count_rulings([&](const TaskRuling& ruling) { return ruling.task == task.id; });
    return world.bindings.contains(task.id) && rulings > 0 ? rulings - 1 : rulings;
  }
  [[nodiscard]] bool has_spare() const {
    return count_rulings([](const TaskRuling& ruling) { return ruling.robot == "spare"; }) > 0;
  }

  std::vector<std::string> hands_;
};

/// Where the run and the interpreter do not agree.
class Differences {
 public:
  Differences(const Played& played, const std::vector<Ended>& expected) : played_(played), expected_(expected) {
    REQUIRE(played_.view.tasks.size() == expected_.size());
    for (std::size_t i = 0; i < expected_.size(); ++i) {
      stopped_ = stopped_ || (ended(i) && expected_[i].holds);
      aborted_ = aborted_ || (ended(i) && expected_[i].aborts);
    }
    for (std::size_t i = 0; i < expected_.size(); ++i) compare(i);
    const RunState state = aborted_ ? RunState::aborted : (stopped_ ? RunState::paused : RunState::finished);
    if (played_.view.state != state) wrong("the run", "is " + std::string(name_of(played_.view.state)));
    if (!played_.begun_once) wrong("", "an attempt was begun twice");
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  [[nodiscard]] const Task& task(std::size_t i) const { return played_.world.scenario.tasks[i]; }
  [[nodiscard]] bool ended(std::size_t i) const {
    const TaskOutcome outcome = played_.view.tasks[i].outcome;
    return outcome != TaskOutcome::none && outcome != TaskOutcome::released;
  }
  void wrong(const std::string& what, const std::string& how) { text_ += what + " " + how + "\n"; }

  void compare(std::size_t i) {
    const TaskView& real = played_.view.tasks[i];
    const Ended& plain = expected_[i];
    if (!plain.reached) {
      if (ended(i) || commands(i) > 0) wrong(real.id, "has begun behind a task that is not final");
    } else if (!same_commands(i)) {
      wrong(real.id, "was commanded otherwise");
    } else if (!ended(i)) {
      if (!is_stopped(i)) wrong(real.id, "waits for nothing, and should be " + std::string(name_of(plain.state)));
    } else if (!was_cancelled(real) && (real.state != plain.state || !all_attempts(i))) {
      wrong(real.id, "is " + std::string(name_of(real.state)) + " after attempt " + std::to_string(real.attempt) +
                         ", should be " + std::string(name_of(plain.state)) + " after " +
                         std::to_string(plain.attempt) + ": " + real.reason);
    }
  }

  [[nodiscard]] std::size_t commands(std::size_t i) const {
    const auto found = played_.given.find(task(i).id);
    return found == played_.given.end() ? 0 : found->second.size();
  }

  /// So far: by its robot, with the data that it should have, attempt by attempt.
  [[nodiscard]] bool same_commands(std::size_t i) const {
    if (commands(i) == 0) return true;
    const auto& given = played_.given.at(task(i).id);
    const auto& plain = expected_[i].commands;
    return given.size() <= plain.size() && std::equal(given.begin(), given.end(), plain.begin());
  }

  [[nodiscard]] bool all_attempts(std::size_t i) const {
    return commands(i) == expected_[i].commands.size() && played_.view.tasks[i].attempt == expected_[i].attempt;
  }

  /// It stood when the run was aborted, or was stopped for that: what has failed then is not tried again.
  [[nodiscard]] bool was_cancelled(const TaskView& real) const {
    const bool stands = real.state == TaskState::failed || real.state == TaskState::retriable;
    return aborted_ && (stands || real.reason.find("the run is aborted") != std::string::npos);
  }

  /// Before the run came to it, it was aborted, or what stands before it waits for a decision. Other branches go on.
  [[nodiscard]] bool is_stopped(std::size_t i) const {
    const auto& after = task(i).after;
    return aborted_ || std::any_of(after.begin(), after.end(),
                                   [&](TaskIndex before) { return !ended(before) || !expected_[before].is_final(); });
  }

  const Played& played_;
  const std::vector<Ended>& expected_;
  bool stopped_ = false;  ///< by a failure that somebody has to decide on
  bool aborted_ = false;
  std::string text_;
};

}  // namespace

TEST_CASE("a random graph ends as a plain sequential interpreter says, in any weather, whoever dies") {
  const std::uint64_t first = from_environment("TRB_SEED", 1);
  const std::uint64_t graphs = from_environment("TRB_GRAPHS", 1000);
  std::map<RunState, int> states;
  std::size_t tasks = 0;
  std::size_t largest = 0;
  std::size_t decisions = 0;
  int double_executions = 0;
  int wrong = 0;
  for (std::uint64_t seed = first; seed < first + graphs && wrong < 3; ++seed) {
    INFO("TRB_SEED=" << seed << " TRB_GRAPHS=1");
    const Played played(seed);
    const std::string text = Differences(played, interpret(played.world)).text();
    CHECK_MESSAGE(text.empty(), text);
    wrong += text.empty() ? 0 : 1;
    ++states[played.view.state];
    decisions += played.view.decisions.size();
    double_executions += played.fleet.counted.contains("double_execution") ? 1 : 0;
    tasks += played.view.tasks.size();
    largest = std::max(largest, played.view.tasks.size());
  }
  MESSAGE(graphs << " graphs from seed " << first << ", " << tasks << " tasks, " << largest
                 << " in the largest: " << states[RunState::finished] << " FINISHED, " << states[RunState::paused]
                 << " PAUSED, " << states[RunState::aborted] << " ABORTED, " << decisions << " decisions");
  CHECK(double_executions == 0);
  if (graphs < 1000) return;
  CHECK(largest > 150);
  CHECK(states[RunState::paused] > 20);
  CHECK(states[RunState::aborted] > 20);
  CHECK(decisions > 100);
}

TEST_CASE("the comparison sees a task that ended otherwise, was told other data, or was not to be done") {
  int seen = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Played played(seed);
    if (played.view.state != RunState::finished) continue;
    const std::vector<Ended> right = interpret(played.world);
    for (std::size_t i = 0; i < right.size(); ++i) {
      std::vector<Ended> other = right;
      other[i].state = right[i].state == TaskState::finished ? TaskState::skipped : TaskState::finished;
      CHECK_FALSE(Differences(played, other).text().empty());
      other = right;
      other[i].reached = false;
      CHECK_FALSE(Differences(played, other).text().empty());
      other = right;
      other[i].commands[9] = {"r1", "{}"};
      CHECK_FALSE(Differences(played, other).text().empty());
      if (right[i].commands.empty()) continue;
      other = right;
      other[i].commands.begin()->second.data += " ";
      CHECK_FALSE(Differences(played, other).text().empty());
      ++seen;
    }
  }
  CHECK(seen > 20);
}
