#include "services/scheduler/core/awaited_robots.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/core/lost_journal.hpp"
#include "services/scheduler/core/robot_schedule.hpp"
#include "services/scheduler/core/waits.hpp"
#include "services/scheduler/test/fleet.hpp"
#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

/// A run whose first task waits for ur3, as the cloud's node, which decides on it, knows it.
struct Waiting {
  explicit Waiting(const Scenario& scenario = chain({"ur3", "drone"})) : known(scenario, "cloud") { end_step(); }

  /// How often the table is requested.
  std::size_t end_step() {
    Outbox out;
    schedule.update_due(known.run(), known.step(out));
    robots.look(known.run(), known.step(out));
    robots.tick(known.step(out));
    return sent<RouteListRequest>(out).size();
  }
  std::size_t pass(double time_s) {
    known.pass(time_s);
    return end_step();
  }
  std::string due_text(const std::string& task = "task-0") const {
    return trb::scheduler::due_text(known.run(), known.runs, known.executor, known.task(task));
  }
  /// The own router tells that of ur3's node.
  std::string tell(const NodeProfile& profile, const std::string& state = "ONLINE") {
    Route route;
    route.id = "ur3";
    route.state = state;
    route.certificate = known.signers.certificate("ur3");
    route.profile = profile;
    robots.on_routes({"cloud", {route}});
    return due_text();
  }

  KnownRun known;
  LostJournal lost;
  RobotSchedule schedule{known.runs, known.executor, lost};
  AwaitedRobots robots{known.self, known.runs};
};

NodeProfile online() {
  NodeProfile out;
  out.robot = "ONLINE";
  return out;
}

const std::string kBegins = "'ur3' to begin task 'task-0'";

}  // namespace

TEST_CASE("the table is requested while a task waits for another node's robot, and not for one that begins at once") {
  Waiting waiting;
  CHECK(waiting.robots.next_deadline() == waiting.known.now.mono + AwaitedRobots::kPatience);
  CHECK(waiting.pass(0.5) == 0);
  CHECK(waiting.pass(0.5) == 1);
  CHECK(waiting.pass(4.9) == 0);
  CHECK(waiting.pass(0.1) == 1);
  waiting.known.run().reports().note_progress(waiting.known.task("task-0"), TaskState::running);
  CHECK(waiting.pass(5) == 0);
  CHECK_FALSE(waiting.robots.next_deadline().has_value());
  Waiting quick;
  quick.known.run().reports().note_progress(quick.known.task("task-0"), TaskState::running);
  CHECK(quick.pass(1) == 0);
  CHECK_FALSE(quick.robots.next_deadline().has_value());
}

TEST_CASE("a task that becomes due after another asks for itself, a second apart at least") {
  Scenario scenario = chain({"ur3", "drone"});
  scenario.tasks[1].after.clear();
  Waiting waiting(scenario);
  Reports& reports = waiting.known.run().reports();
  reports.note_progress(waiting.known.task("task-1"), TaskState::running);
  waiting.end_step();
  REQUIRE(waiting.pass(1) == 1);
  reports.forget_progress(waiting.known.task("task-1"));
  waiting.known.run().work().timers().set_due({0, 1}, waiting.known.now.mono);
  CHECK(waiting.end_step() == 0);
  CHECK(waiting.robots.next_deadline() == waiting.known.now.mono + seconds(1));
  CHECK(waiting.pass(1) == 1);
  CHECK(waiting.robots.next_deadline() == waiting.known.now.mono + AwaitedRobots::kAgain);
}

TEST_CASE("a task says what keeps its robot, and what cures it, by what the robot's node tells of itself") {
  Waiting waiting;
  CHECK(waiting.due_text() == kBegins + ", passed on by 'cloud'");
  CHECK(waiting.tell(online()) == kBegins + ", passed on by 'cloud'");
  NodeProfile profile = online();
  profile.fenced = true;
  CHECK(waiting.tell(profile) == kBegins + ": the robot is stopped until 'trb release'");
  profile = online();
  profile.control = "ann";
  CHECK(waiting.tell(profile) == kBegins + ": the robot is controlled by 'ann', until 10 s after its last command");
  profile = online();
  profile.out_of_use = {{"", Severity::warning, "new wheels", 0, true, "bob"}};
  CHECK(waiting.tell(profile) ==
        kBegins + ": the robot is out of service: new wheels (bob); trb robot return takes it back");
  profile.out_of_use = {{"", Severity::critical, "the motors are off", 0, false, ""}};
  CHECK(waiting.tell(profile) == kBegins +
                                     ": the robot is out of use: CRITICAL: the motors are off; once it is mended, "
                                     "and if the robot itself does not say so: trb robot repaired");
  profile = online();
  profile.robot = "OFFLINE";
  profile.detail = "it refused the sign-in";
  CHECK(waiting.tell(profile) == kBegins + ": the robot is OFFLINE: it refused the sign-in");
  CHECK(waiting.tell(online(), "OFFLINE") == kBegins + ": its node is not reached");
  CHECK(waiting.tell(online()) == kBegins + ", passed on by 'cloud'");
}

TEST_CASE("a task with a condition is passed on by the node that has evaluated it") {
  Scenario scenario = chain({"ur3", "drone", "drone"});
  scenario.tasks[1].after = {};
  scenario.tasks[2].after = {0, 1};
  scenario.tasks[2].when = {{"temperature", "conveyor", "", Comparison::more, false, 20, "", "degC"}};
  KnownRun known(scenario, "cloud");
  known.finish("task-0");
  known.finish("task-1");
  REQUIRE(known.run().apply(JournalChoice{known.choice("ur3", "task-2", 21)}).ok());
  CHECK(due_text(known.run(), known.runs, known.executor, 2) == "'drone' to begin task 'task-2', passed on by 'ur3'");
}

TEST_CASE("what keeps nobody: a run's own lease, a profile that is not there yet, a fault of what is not needed") {
  Waiting waiting;
  const std::string free = kBegins + ", passed on by 'cloud'";
  NodeProfile profile = online();
  profile.control = "run " + kKnownRun;
  CHECK(waiting.tell(profile) == free);
  profile = {};
  CHECK(waiting.tell(profile) == free);
  profile = online();
  profile.skills.push_back({waiting.known.run().tasks()[0].skill, "grasp", {}, false, 0});
  profile.out_of_use = {{"weld", Severity::fatal, "no gas", 0, false, ""}};
  CHECK(waiting.tell(profile) == free);
  profile.out_of_use[0].capability = "grasp";
  CHECK(waiting.tell(profile) == kBegins +
                                     ": its 'grasp' is out of use: FATAL: no gas; once it is mended, and if the robot "
                                     "itself does not say so: trb robot repaired");
}

TEST_CASE("a node that has got new keys since can do no more of the run, also if it is not reached or owes a baton") {
  const std::string words =
      kBegins +
      ": its node has got new keys since, and can do no more of the run; trb alert decide gives the task to another, "
      "with --stands once somebody has seen that the robot stands";
  Waiting waiting;
  waiting.known.signers.add("ur3", Role::robot);
  CHECK(waiting.tell(online()) == words);
  CHECK(waiting.tell(online(), "OFFLINE") == words);
  waiting.known.run().deliveries().pending().owe(DeliveryKind::baton, "ur3", {0});
  CHECK(waiting.due_text() == words);
}

TEST_CASE("the run says it at once, and whoever watches it is told; what one robot tells is said of no other") {
  Waiting waiting;
  const Run& run = waiting.known.run();
  const auto shown = [&] {
    return waits_for(run, waiting.known.runs, waiting.known.executor, {waiting.known.now.mono, waiting.known.now.utc});
  };
  CHECK(shown().empty());
  const std::uint64_t before = run.version();
  NodeProfile stopped = online();
  stopped.fenced = true;
  waiting.tell(stopped);
  CHECK(shown() == kBegins + ": the robot is stopped until 'trb release'");
  CHECK(run.version() == before + 1);
  waiting.tell(stopped);
  CHECK(run.version() == before + 1);
  waiting.known.decide({{"task-0", Ruling::move, "pioneer", 2, Evidence::word}});
  waiting.end_step();
  CHECK(waiting.due_text().find("stopped") == std::string::npos);
}

TEST_CASE("the cloud says that a robot is stopped, seconds after its task is due; released, it begins") {
  Fleet fleet;
  add_demonstration(fleet);
  fleet["ur3"].profile.robot = "ONLINE";
  fleet["ur3"].adapter.set(true, true);
  fleet.ask("cloud", MessageType::command,
            RunSubmit{fleet.make_start(chain({"ur3"}), "cloud", seconds(3600), kKnownRun)});
  fleet.pass(seconds(3));
  const RunView view = fleet.view("cloud", kKnownRun);
  CHECK(view.waits_for == kBegins + ": the robot is stopped until 'trb release'");
  CHECK(view.tasks.at(0).waits_for == view.waits_for);
  fleet["ur3"].adapter.set(true, false);
  CHECK(fleet.until([&] { return fleet.view("cloud", kKnownRun).state == RunState::finished; }));
}
