#include "tests/year/hall.hpp"

#include <algorithm>

#include "common/scenario/run_start.hpp"

namespace trb::year {

using scheduler::test::Node;

namespace {

constexpr std::size_t kRobots = 20;
constexpr double kBetween_s = 26;  ///< 100,000 runs in 30 days
constexpr double kLife_s = 24 * 3600;
constexpr std::size_t kMostTold = 20;

/// A policy that decides by itself, with hard minimums; a person decides the rest.
ResilienceSettings policy() {
  ResilienceSettings out = default_resilience();
  out.policy.automatic = true;
  return out;
}

std::string number(std::size_t i) {
  char out[4];
  std::snprintf(out, sizeof out, "%02zu", i);
  return out;
}

}  // namespace

Hall::Hall(std::uint64_t seed) : dice_(seed), fleet_(seed), decider_(fleet_, policy()) {
  fleet_.add("cloud", Role::cloud).archive->keep_most(2'000);
  for (std::size_t i = 1; i <= kRobots; ++i) {
    const std::string id = "r" + number(i);
    robots_.push_back(id);
    Node& node = fleet_.add(id, Role::robot);
    node.archive->keep_most(500);
    node.profile.robot = "ONLINE";
    node.profile.capabilities = {"hands", "wheels"};
    node.profile.skills = {{"grip", "hands", {}, false, 60}, {"drive", "wheels", {}, true, 60}};
    node.profile.frame = {1, 0, 0, 0};
    node.values["state_of_charge"] = std::to_string(30 + dice_.below(70));
    node.values["position"] = "[" + std::to_string(dice_.below(50)) + ", " + std::to_string(dice_.below(50)) + "]";
    node.adapter.skills = {{"grip", "hands", false}, {"drive", "wheels", true}};
    node.adapter.skill_time = seconds(static_cast<double>(dice_.from(2, 14)));
    node.adapter.world = [this, id](const Execute& execute) { return work(id, execute); };
  }
  fleet_.weather = {5, 5, 1, seconds(0.05)};
  fleet_.coded_every = 16;  // 1.4 million a day: the codecs have tests of their own
  decider_.start();
}

void Hall::tell(const std::string& what) {
  if (errors.size() < kMostTold) errors.push_back(to_iso8601(fleet_.now().utc) + " " + what);
}

/// One task in 200 fails; of those one in four with a fault that takes the capability for half an hour.
std::pair<TaskOutcome, std::string> Hall::work(const std::string& robot, const Execute& execute) {
  const auto known = open_.find(execute.key.run);
  if (known == open_.end()) {
    ++figures.twice;
    tell("task " + execute.key.task + " of run " + execute.key.run + " was begun on " + robot + " after the run's end");
    return {TaskOutcome::finished, ""};
  }
  if (dice_.below(200) == 0) {
    ++figures.failures;
    if (dice_.percent(25)) {
      ++figures.faults;
      const std::string capability = execute.skill == "grip" ? "hands" : "wheels";
      fleet_[robot].adapter.set_out_of_use(
          {{capability, Severity::critical, "is stuck", fleet_.now().utc.ns, false, ""}});
      fleet_.after(seconds(1800), [this, robot] { fleet_[robot].adapter.set_out_of_use({}); });
    }
    return {TaskOutcome::failed, ""};
  }
  if (!known->second.done.insert(execute.key.task).second && !known->second.unknown.contains(execute.key.task)) {
    ++figures.twice;
    tell("task " + execute.key.task + " of run " + execute.key.run + " was done twice, now by " + robot);
  }
  return {TaskOutcome::finished, R"({"n":1})"};
}

Scenario Hall::scenario(const std::vector<std::string>& team) {
  Scenario out;
  out.name = "work";
  const std::size_t tasks = dice_.from(3, 30);
  for (std::size_t i = 0; i < tasks; ++i) {
    Task task;
    task.id = "t" + std::to_string(i);
    task.skill = dice_.percent(50) ? "grip" : "drive";
    task.robot = dice_.one_of(team);
    if (dice_.percent(3)) {  // any robot that can
      task.robot.clear();
      task.requires_ = {task.skill == "grip" ? "hands" : "wheels"};
    }
    if (i > 0 && !dice_.percent(10))
      task.after = {static_cast<std::uint16_t>(i - 1 - dice_.below(std::min<std::size_t>(i, 3)))};
    task.retries = dice_.percent(20) ? 1 : 0;
    if (dice_.percent(20)) task.on_failure = dice_.percent(50) ? OnFailure::skip : OnFailure::continue_;
    if (dice_.percent(3)) task.on_failure = OnFailure::abort;
    if (dice_.percent(5) && task.on_failure != OnFailure::resilience) task.start_within_s = 120;
    out.tasks.push_back(std::move(task));
  }
  return out;
}

void Hall::submit() {
  if (!takes_work_) return;
  fleet_.after(seconds(kBetween_s * 0.02 * static_cast<double>(dice_.below(100))), [this] { submit(); });
  std::set<std::string> team;
  for (std::size_t i = 0, count = dice_.from(2, 5); i < count; ++i) team.insert(dice_.one_of(robots_));
  const std::vector<std::string> names(team.begin(), team.end());
  Scenario work = scenario(names);
  char id[33];
  std::snprintf(id, sizeof id, "%032llx", static_cast<unsigned long long>(++count_));
  const std::string node = dice_.percent(80) || !fleet_[names[0]].up ? "cloud" : names[0];
  if (!fleet_[node].up) return;
  std::vector<Member> members{fleet_.member("cloud")};
  for (const std::string& robot : names) members.push_back(fleet_.member(robot));
  std::vector<std::string> robots;
  for (const Task& task : work.tasks) robots.push_back(task.robot.empty() ? "cloud" : task.robot);
  const UtcTime now = fleet_.now().utc;
  RunStart start = build_run_start(std::move(work), members, node, now, now + seconds(kLife_s), id, std::move(robots));
  start.priority = static_cast<std::uint32_t>(dice_.below(3));
  ++figures.runs;
  figures.tasks += start.scenario.tasks.size();
  open_[id] = {{}, {}, fleet_.now().mono, start.scenario.tasks.size()};
  fleet_.answers.clear();
  fleet_.ask(node, MessageType::command, RunSubmit{fleet_.sign(node, kSignedRunStart, encode(start))});
  if (fleet_.answers.empty() || !holds_alternative<RunAccepted>(fleet_.answers.back())) {
    tell("run " + std::string(id) + " was refused by " + node);
    ++figures.lost;
  }
}

/// A node's services restart, in one case of two a robot's mode-adapter too: then the outcome of its task is unknown.
void Hall::restart(const std::string& node) {
  ++figures.restarts;
  if (!fleet_[node].up) return;
  fleet_.stop(node);
  fleet_.after(seconds(static_cast<double>(dice_.from(1, 60))), [this, node] {
    fleet_.start(node);
    if (node == "cloud") return decider_.start();
    if (dice_.percent(50)) return;
    for (const AttemptKey& key : fleet_[node].adapter.restart()) {
      if (const auto run = open_.find(key.run); run != open_.end()) run->second.unknown.insert(key.task);
    }
  });
}

void Hall::cut(const std::string& node) {
  ++figures.cuts;
  fleet_[node].cut = true;
  if (node != "cloud") decider_.tell(PeerExpired{node, "silent"});
  fleet_.after(seconds(60.0 * static_cast<double>(dice_.from(1, 30))), [this, node] {
    fleet_[node].cut = false;
    if (node != "cloud") decider_.tell(PeerJoined{node});
  });
}

std::string Hall::what_differs(const RunView& view, const std::set<std::string>& done) {
  std::string out;
  for (const TaskView& task : view.tasks) {
    if (task.state == TaskState::finished || !done.contains(task.id)) continue;
    out += "; " + task.id + " of " + task.robot + " is " + std::string(name_of(task.state)) + " (" + task.reason + ")";
    for (const DecisionView& decision : view.decisions) {
      for (const TaskRuling& ruling : decision.tasks) {
        if (ruling.task == task.id) out += ", decided by " + decision.by + decision.person + ": " + decision.reason;
      }
    }
  }
  return out;
}

/// Every five minutes a person looks at what waits for one.
void Hall::look() {
  if (fleet_["cloud"].up) {
    count_ended();
    for (const Alert& alert : decider_.alerts()) decide(alert);
    const MonotonicTime now = fleet_.now().mono;
    std::size_t open = 0;
    for (const auto& [id, known] : std::map(open_)) {
      const RunView view = fleet_.view("cloud", id);
      ++open;
      if (view.run.empty() || view.over != 0) continue;
      look_at(view, now);
    }
    figures.most_open = std::max(figures.most_open, open);
    figures.most_alerts = std::max(figures.most_alerts, decider_.most_alerts);
  }
  for (const auto& member : fleet_.members()) {
    figures.most_journal = std::max(figures.most_journal, fleet_[member.id].journal.size());
  }
  fleet_.after(seconds(300), [this] { look(); });
}

/// A run without progress for a quarter of an hour must show what it waits for.
void Hall::look_at(const RunView& view, MonotonicTime now) {
  const bool runs = std::ranges::any_of(view.tasks, [](const TaskView& task) {
    return task.state == TaskState::running || task.state == TaskState::initializing;
  });
  if (runs || !view.waits_for.empty()) {
    silent_.erase(view.run);
  } else if (const auto [at, is_new] = silent_.try_emplace(view.run, now); !is_new && now - at->second > seconds(900)) {
    ++figures.nameless;
    tell("run " + view.run + " is " + std::string(name_of(view.state)) + " and waits for nothing that is named");
    silent_.erase(view.run);
  }
}

void Hall::decide(const Alert& alert) {
  if (fleet_.now().utc.ns - alert.time < 300'000'000'000 || alert.run.empty()) return;
  // For a robot that cannot be reached no person states that it stands: it may go on with its tasks. Nor can a person
  // who reaches no robot at all.
  if (fleet_["cloud"].cut) return;
  if (!alert.robot.empty() && (fleet_[alert.robot].cut || !fleet_[alert.robot].up)) return;
  const std::string held = fleet_.view("cloud", alert.run).paused_by;
  if (alert.cause == "double_execution" || alert.cause == "run_ends" || !held.empty()) return;
  AlertDecide word;
  word.alert = alert.id;
  word.person = "ann";
  word.reason = "looked at it";
  word.stands = true;
  word.verdict = alert.proposals.empty() ? Verdict::skip : Verdict::accept;
  ++figures.words;
  const Body answer = decider_.decide(word);
  if (holds_alternative<Ack>(answer)) return;
  word.verdict = Verdict::skip;
  decider_.decide(word);
}

/// Runs that are over are removed; none of their results may be missing.
void Hall::count_ended() {
  for (auto at = open_.begin(); at != open_.end();) {
    const auto record = fleet_["cloud"].archive->record(at->first);
    if (!record) {
      ++at;
      continue;
    }
    const RunView& view = record->view;
    figures.finished += view.state == RunState::finished ? 1 : 0;
    figures.aborted += view.state == RunState::aborted ? 1 : 0;
    figures.expired += view.state == RunState::expired || view.state == RunState::aborting ? 1 : 0;
    figures.decisions += view.decisions.size();
    const auto is_open = [](const TaskView& task) {
      return task.state != TaskState::finished && task.state != TaskState::skipped;
    };
    const bool lost = view.tasks.size() != at->second.tasks ||
                      (view.state == RunState::finished && std::ranges::any_of(view.tasks, is_open)) ||
                      std::ranges::any_of(view.tasks, [&](const TaskView& task) {
                        return at->second.done.contains(task.id) && !at->second.unknown.contains(task.id) &&
                               task.state != TaskState::finished && view.state == RunState::finished;
                      });
    if (lost) {
      ++figures.lost;
      tell("run " + at->first + " is " + std::string(name_of(view.state)) + " without all that was done" +
           what_differs(view, at->second.done));
    }
    for (const std::string& robot : robots_) fleet_[robot].adapter.forget(at->first);
    at = open_.erase(at);
  }
}

void Hall::day() {
  if (count_ == 0) {
    fleet_.after(seconds(1), [this] { submit(); });
    fleet_.after(seconds(300), [this] { look(); });
  }
  const auto some_time = [&] { return seconds(static_cast<double>(dice_.below(86'000))); };
  for (const std::string& robot : robots_) fleet_.after(some_time(), [this, robot] { restart(robot); });
  fleet_.after(some_time(), [this] { restart("cloud"); });
  fleet_.after(some_time(), [this] { cut(dice_.percent(90) ? dice_.one_of(robots_) : "cloud"); });
  fleet_.pass(std::chrono::hours(24));
}

void Hall::finish() {
  takes_work_ = false;
  fleet_.pass(std::chrono::hours(25));
  count_ended();
  for (const auto& [run, known] : open_) {
    ++figures.lost;
    tell("run " + run + " never ended");
  }
}

}  // namespace trb::year
