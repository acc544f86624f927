// A judge with an empty journal gets a run from its submitter, who passes it for the first time: it is new. Or somebody
// says so, and it is not.
#include <doctest/doctest.h>

#include "common/scenario/run_start.hpp"
#include "common/scenario/test/make_task.hpp"
#include "services/scheduler/test/decision_story.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

/// The drone submits; ur3's task fails, and the run waits for a decision of the cloud, its judge.
struct FirstPass {
  FirstPass() {
    fleet.add("cloud", Role::cloud);
    for (const char* robot : {"drone", "pioneer", "ur3"}) fleet.add(robot, Role::robot);
    fleet["ur3"].adapter.endings["grip"] = TaskOutcome::failed;
  }
  void submit(Duration ahead = {}) {
    const Scenario scenario{"first",
                            "",
                            {make_task("grip", "ur3", "grip"), make_task("fly", "drone", "fly", {0}),
                             make_task("drive", "pioneer", "drive", {0})}};
    const UtcTime created = fleet.now().utc + ahead;
    start = fleet.sign(
        "drone", kSignedRunStart,
        encode(build_run_start(scenario, fleet.members(), "drone", created, created + seconds(7200), kStoryRun)));
    fleet.ask("drone", MessageType::command, RunSubmit{start});
  }
  /// The cloud hears the drone say so.
  void pass_first() {
    Baton baton;
    baton.run = kStoryRun;
    baton.digest = decode<RunStart>(start.payload.bytes)->digest;
    baton.epoch = 1;
    baton.final_tasks.bytes = to_bitmap(std::vector<bool>(3));
    baton.skipped_tasks.bytes = baton.final_tasks.bytes;
    fleet.hear("cloud", "drone", MessageType::command, baton);
  }
  void decide(const char* task, Ruling ruling, const char* robot) {
    fleet.ask("cloud", MessageType::command,
              RunDecision{Decider(fleet, "", {}, "").decision({{task, ruling, robot, 2, Evidence::word}})});
  }
  RunView view() { return fleet["cloud"].up ? fleet.view("cloud", kStoryRun) : RunView{}; }
  bool is_due_for_decision() { return view().waits_for.starts_with("task 'grip' failed"); }
  Fleet fleet;
  SignedRecord start;
};

}  // namespace

TEST_CASE("a cloud that was cut off hears late of a new run, and waits for nobody who is off") {
  FirstPass story;
  story.fleet["cloud"].cut = true;
  story.fleet.stop("pioneer");
  story.submit();
  story.fleet.pass(seconds(1800));
  SUBCASE("from its submitter") {}
  SUBCASE("from its submitter, and is killed before it knows that the run is new") {
    story.fleet["cloud"].crash.at = 2;
  }
  story.fleet["cloud"].cut = false;
  REQUIRE(story.fleet.until([&] { return story.view().run == kStoryRun; }, seconds(1400)));
  CHECK(story.fleet.until([&] { return story.is_due_for_decision(); }, seconds(15)));
  CHECK(story.view().state == RunState::paused);
}

TEST_CASE("a run that is not new is recovered, though its submitter says that it passes it for the first time") {
  FirstPass story;
  story.submit();
  REQUIRE(story.fleet.until([&] { return story.is_due_for_decision(); }, seconds(60)));
  story.fleet["drone"].cut = true;
  story.decide("grip", Ruling::move, "pioneer");
  REQUIRE(story.fleet.until([&] { return story.view().tasks[0].outcome == TaskOutcome::finished; }, seconds(60)));
  story.fleet.pass(seconds(1800));
  story.fleet.stop("cloud");
  story.fleet["cloud"].journal = {};
  story.fleet["drone"].cut = false;
  story.fleet.start("cloud");
  story.pass_first();
  story.fleet.pass(seconds(2));
  REQUIRE(story.view().run == kStoryRun);
  CHECK(story.view().epoch == 2);
}

TEST_CASE(
    "after a lost journal a new run of a clock that is ahead is recovered, until the clocks show that it is new") {
  FirstPass story;
  story.fleet.stop("cloud");
  story.fleet["cloud"].journal = {JournalLost{(story.fleet.now().utc - seconds(7200)).ns, true}};
  story.fleet.start("cloud");
  story.fleet["drone"].clock.set({.ahead_s = 900});
  story.fleet.stop("pioneer");
  story.submit(seconds(900));
  REQUIRE(story.fleet.until([&] { return story.view().run == kStoryRun; }, seconds(60)));
  story.fleet.pass(seconds(10));
  CHECK(story.view().state == RunState::paused);
  CHECK(story.view().waits_for.starts_with("'pioneer' to tell"));
  CHECK(story.view().waits_for.find("clocks") != std::string::npos);
  SUBCASE("at once") {}
  SUBCASE("after a restart") {
    story.fleet.stop("cloud");
    story.fleet.start("cloud");
  }
  story.fleet.pass(seconds(330));
  CHECK(story.is_due_for_decision());
}

TEST_CASE("a judge does not wait for a member that has of a run no more than that it is over") {
  Fleet fleet;
  fleet.add("cloud", Role::cloud);
  for (const char* robot : {"drone", "ur3"}) fleet.add(robot, Role::robot);
  const Scenario scenario{
      "over",
      "",
      {make_task("grip", "ur3", "grip"), make_task("pack", "ur3", "pack", {0}), make_task("fly", "drone", "fly", {1})}};
  fleet["drone"].archive->keep_most(0);
  fleet.ask("cloud", MessageType::command, RunSubmit{fleet.make_start(scenario, "cloud", seconds(3600), kStoryRun)});
  REQUIRE(fleet.until([&] { return fleet["ur3"].adapter.begun.size() == 1; }));
  fleet["ur3"].cut = true;
  for (const char* node : {"cloud", "drone"}) {
    fleet.tell(node, node, MessageType::information, PeerExpired{"ur3", "cert_revoked: stolen"});
  }
  fleet.ask("cloud", MessageType::command, RunAbort{fleet.sign_order("cloud", kStoryRun)});
  REQUIRE(fleet.until([&] { return fleet["drone"].archive->over(kStoryRun).has_value(); }));
  fleet.pass(seconds(120));
  fleet.stop("cloud");
  fleet["cloud"].journal = {};
  fleet["cloud"].archive = std::make_unique<MemoryArchive>();
  fleet.start("cloud");
  fleet["ur3"].cut = false;
  REQUIRE(fleet.until([&] { return fleet.view("cloud", kStoryRun).run == kStoryRun; }, seconds(1400)));
  fleet.pass(seconds(10));
  CHECK_FALSE(fleet.view("cloud", kStoryRun).waits_for.starts_with("'drone' to tell"));
}
