// A robot's node whose journal was lost, and whose robot a person has looked at: what it has done is not done again,
// and all else goes on. And a cloud's: what it has decided and signed stays so.
#include <doctest/doctest.h>

#include "common/scenario/run_start.hpp"
#include "common/scenario/test/make_task.hpp"
#include "services/scheduler/test/decision_story.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

Task lost_task(const char* id, const char* robot, std::vector<TaskIndex> after) {
  return make_task(id, robot, id, std::move(after));
}

/// With nothing that says that it had one, as with a new disk. It is down then.
void lose_journal_of_cloud(Fleet& fleet) {
  fleet.stop("cloud");
  fleet["cloud"].journal = {};
}

/// The UR's node loses its journal while the drone flies.
struct LossStory {
  explicit LossStory(const std::vector<const char*>& robots = {"drone", "ur3"}, const std::string& from = "cloud")
      : submitter(from) {
    if (submitter == "cloud") fleet.add("cloud", Role::cloud);
    for (const char* robot : robots) fleet.add(robot, Role::robot);
    adapter("drone").skill_time = seconds(20);
  }
  void submit(std::vector<Task> tasks) {
    const SignedRecord start = fleet.make_start({"loss", "", std::move(tasks)}, submitter, seconds(3600), kStoryRun);
    fleet.ask(submitter, MessageType::command, RunSubmit{start});
  }
  void lose_journal() {
    fleet.stop("ur3");
    fleet["ur3"].journal = {JournalLost{fleet.now().utc.ns, true}};
    adapter("ur3").restart();
    fleet.start("ur3");
  }
  void retry(const char* task, std::uint32_t attempt) {
    const Decider decider(fleet, "", {}, "");
    const SignedRecord decision = decider.decision({{task, Ruling::retry, "ur3", attempt, Evidence::word}});
    fleet.ask("cloud", MessageType::command, RunDecision{decision});
  }
  FakeAdapter& adapter(const std::string& robot) { return fleet[robot].adapter; }
  std::size_t begun() { return adapter("ur3").begun.size(); }
  bool begins(std::size_t count) {
    return fleet.until([&] { return begun() >= count; }, seconds(120));
  }
  bool knows_run() {
    return fleet.until([&] { return fleet.view("ur3", kStoryRun).run == kStoryRun; }, seconds(60));
  }
  TaskOutcome outcome(std::size_t task) { return fleet.view(submitter, kStoryRun).tasks.at(task).outcome; }
  bool ends(RunState state = RunState::finished) {
    return fleet.until([&] { return fleet.view(submitter, kStoryRun).state == state; }, seconds(300));
  }
  std::string submitter;
  Fleet fleet;
};

}  // namespace

TEST_CASE("what was done in an epoch that is not known here any more is not done again") {
  LossStory story;
  story.adapter("ur3").endings["grip"] = TaskOutcome::failed;
  story.submit({lost_task("grip", "ur3", {}), lost_task("fly", "drone", {}), lost_task("pack", "ur3", {1})});
  REQUIRE(story.ends(RunState::paused));
  story.fleet["drone"].cut = true;
  story.adapter("ur3").endings.clear();
  story.retry("grip", 2);
  REQUIRE(story.fleet.until([&] { return story.outcome(0) == TaskOutcome::finished; }, seconds(60)));
  story.fleet.pass(seconds(30));
  // The drone, still in epoch 1, passes its baton on; the cloud's node comes back after that.
  story.fleet.stop("cloud");
  story.lose_journal();
  story.fleet["drone"].cut = false;
  REQUIRE(story.knows_run());
  story.fleet.pass(seconds(1));
  story.fleet["drone"].cut = true;
  story.fleet.start("cloud");
  REQUIRE(story.begins(3));
  CHECK(story.fleet.view("ur3", kStoryRun).epoch == 2);
  story.fleet["drone"].cut = false;
  REQUIRE(story.ends());
  CHECK(story.begun() == 3);
}

TEST_CASE("a task that has failed keeps no other from beginning, and may be repeated itself") {
  LossStory story;
  story.adapter("ur3").endings["grip"] = TaskOutcome::failed;
  story.submit({lost_task("grip", "ur3", {}), lost_task("fly", "drone", {}), lost_task("pack", "ur3", {1})});
  REQUIRE(story.ends(RunState::paused));
  story.lose_journal();
  REQUIRE(story.begins(2));
  story.adapter("ur3").endings.clear();
  story.retry("grip", 2);
  REQUIRE(story.ends());
  CHECK(story.begun() == 3);
}

TEST_CASE("of a run without a cloud its submitter is asked") {
  LossStory story({"drone", "ur3"}, "drone");
  story.submit({lost_task("grip", "ur3", {}), lost_task("fly", "drone", {0}), lost_task("pack", "ur3", {1})});
  REQUIRE(story.fleet.until([&] { return story.adapter("drone").begun.size() == 1; }));
  story.lose_journal();
  REQUIRE(story.ends());
  CHECK(story.begun() == 2);
}

TEST_CASE("a cloud that lost its journal learns of a run that waits for a decision, and decides it") {
  LossStory story;
  story.adapter("ur3").endings["grip"] = TaskOutcome::failed;
  story.submit({lost_task("grip", "ur3", {}), lost_task("fly", "drone", {0})});
  REQUIRE(story.ends(RunState::paused));
  lose_journal_of_cloud(story.fleet);
  story.fleet.start("cloud");
  REQUIRE(story.ends(RunState::paused));
  story.adapter("ur3").endings.clear();
  story.retry("grip", 2);
  REQUIRE(story.ends());
  CHECK(story.begun() == 2);
}

TEST_CASE(
    "a cloud that lost its journal waits for a member that does not answer, says so, and decides nothing before") {
  LossStory story;
  story.adapter("ur3").endings["grip"] = TaskOutcome::failed;
  story.submit({lost_task("grip", "ur3", {}), lost_task("fly", "drone", {0})});
  REQUIRE(story.ends(RunState::paused));
  lose_journal_of_cloud(story.fleet);
  story.fleet["drone"].cut = true;
  story.fleet.start("cloud");
  const auto view = [&] { return story.fleet.view("cloud", kStoryRun); };
  REQUIRE(story.fleet.until([&] { return view().waits_for.starts_with("'drone' to tell what was decided"); }));
  CHECK(view().state == RunState::running);  // it may take a moment
  story.fleet.pass(seconds(5));
  CHECK(view().state == RunState::paused);
  CHECK(view().recovers);
  story.adapter("ur3").endings.clear();
  story.fleet.answers.clear();
  story.retry("grip", 2);
  REQUIRE(get_if<Nack>(&story.fleet.answers.back()) != nullptr);
  CHECK(get_if<Nack>(&story.fleet.answers.back())->code == "timeout");  // who has decided decides it again
  CHECK(get_if<Nack>(&story.fleet.answers.back())->what.find("not known here yet") != std::string::npos);
  SUBCASE("who has told all is not asked again after a restart, and the drone is still waited for") {
    story.fleet.stop("cloud");
    story.fleet.start("cloud");
    story.fleet.pass(seconds(20));
    CHECK(view().waits_for.starts_with("'drone' to tell"));
    CHECK(view().epoch == 1);
    story.fleet["drone"].cut = false;
  }
  SUBCASE("its certificate is revoked: nobody waits for it") {
    story.fleet.tell("cloud", "cloud", MessageType::information, PeerExpired{"drone", "cert_revoked: stolen"});
    story.fleet.pass(seconds(1));
    CHECK(view().waits_for.starts_with("task 'grip' failed"));
    story.fleet["drone"].cut = false;
  }
  SUBCASE("it was revoked before this service began, or this node has met it") {
    const std::uint64_t serial = decode<Certificate>(story.fleet.member("drone").certificate.payload.bytes)->serial;
    const auto tell = [&](std::uint64_t up_to) {
      story.fleet.tell("cloud", "cloud", MessageType::information, RevokedNodes{{{"drone", up_to}}});
      story.fleet.pass(seconds(1));
    };
    tell(serial - 1);  // an earlier one: it is a member again since
    CHECK(view().waits_for.starts_with("'drone' to tell"));
    tell(serial);
    CHECK(view().waits_for.starts_with("task 'grip' failed"));
    story.fleet["drone"].cut = false;
  }
  SUBCASE("the run can be aborted") {
    story.fleet.ask("cloud", MessageType::command, RunAbort{story.fleet.sign_order("cloud", kStoryRun)});
    story.fleet["drone"].cut = false;
    REQUIRE(story.ends(RunState::aborted));
    return;
  }
  REQUIRE(story.fleet.until([&] { return view().waits_for.starts_with("task 'grip' failed"); }, seconds(60)));
  story.retry("grip", 2);
  REQUIRE(story.ends());
  CHECK(story.begun() == 2);
}

TEST_CASE("a cloud that lost its journal, and hears first of a member that is behind, has nothing done twice") {
  for (const bool is_alone : {true, false}) {
    CAPTURE(is_alone);
    Fleet fleet;
    add_demonstration(fleet);
    const Scenario scenario{"behind",
                            "",
                            {lost_task("c0", "conveyor", {}), lost_task("t0", "ur3", {}),
                             lost_task("t1", "ridgeback", {1}), lost_task("t2", "drone", {})}};
    fleet["drone"].adapter.endings = {{"t2", TaskOutcome::failed}};
    fleet.stop("ridgeback");
    fleet.ask("cloud", MessageType::command, RunSubmit{start_without(fleet, scenario, {})});
    const auto view = [&] { return fleet.view("cloud", kStoryRun); };
    const auto is = [&](std::size_t task, TaskState state) { return view().tasks.at(task).state == state; };
    REQUIRE(fleet.until([&] { return is(0, TaskState::finished) && is(1, TaskState::finished); }, seconds(60)));
    fleet.pass(seconds(5));
    // The conveyor does not hear that t1 was moved, and done.
    fleet["conveyor"].cut = true;
    const Decider decider(fleet, "", {}, "");
    fleet.ask("cloud", MessageType::command,
              RunDecision{decider.decision({{"t1", Ruling::move, "pioneer", 2, Evidence::word}})});
    REQUIRE(fleet.until([&] { return is(2, TaskState::finished) && is(3, TaskState::failed); }, seconds(120)));
    fleet.pass(seconds(10));
    lose_journal_of_cloud(fleet);
    fleet["conveyor"].cut = false;
    for (const char* one : {"ur3", "pioneer", "drone"}) fleet[one].cut = is_alone;
    fleet.start("cloud");
    REQUIRE(fleet.until([&] { return view().run == kStoryRun; }, seconds(1400)));
    for (const char* one : {"ur3", "pioneer", "drone"}) fleet[one].cut = false;
    fleet.start("ridgeback");
    fleet.pass(seconds(60));
    CHECK(view().epoch == 2);
    CHECK(is(2, TaskState::finished));
    CHECK(fleet["ridgeback"].adapter.begun.empty());
    fleet["drone"].adapter.endings.clear();
    fleet.ask("cloud", MessageType::command,
              RunDecision{decider.decision({{"t2", Ruling::retry, "drone", 2, Evidence::result}})});
    CHECK(fleet.until([&] { return view().state == RunState::finished; }));
    CHECK(fleet["ridgeback"].adapter.begun.empty());
    CHECK(fleet.counted["double_execution"] == 0);
  }
}

TEST_CASE("a cloud that has its decision back from others passes it on to a robot that does not have it") {
  LossStory story;
  story.adapter("drone").endings["fly"] = TaskOutcome::failed;
  story.adapter("ur3").set(false, false);
  story.submit({lost_task("grip", "ur3", {}), lost_task("fly", "drone", {})});
  REQUIRE(story.knows_run());
  story.fleet.pass(seconds(5));
  story.fleet["ur3"].cut = true;
  const Decider decider(story.fleet, "", {}, "");
  story.fleet.ask("cloud", MessageType::command,
                  RunDecision{decider.decision({{"grip", Ruling::move, "drone", 2, Evidence::word}})});
  REQUIRE(story.fleet.until([&] { return story.outcome(0) == TaskOutcome::finished; }, seconds(120)));
  story.fleet.pass(seconds(10));
  lose_journal_of_cloud(story.fleet);
  story.fleet.start("cloud");
  const auto view = [&] { return story.fleet.view("cloud", kStoryRun); };
  REQUIRE(story.fleet.until([&] { return view().epoch == 2; }, seconds(1400)));
  SUBCASE("at once") {}
  SUBCASE("after a restart") {
    story.fleet.stop("cloud");
    story.fleet.start("cloud");
  }
  story.fleet["ur3"].cut = false;
  REQUIRE(story.fleet.until([&] { return view().waits_for.starts_with("task 'fly' failed"); }, seconds(60)));
  story.fleet.pass(seconds(5));
  story.adapter("ur3").set(true, false);
  story.fleet.pass(seconds(60));
  CHECK(story.fleet.view("ur3", kStoryRun).epoch == 2);
  CHECK(story.begun() == 0);
}

TEST_CASE("what a cloud has SKIPPED is not done, though its journal is lost, and a robot would be there by now") {
  Fleet fleet;
  add_demonstration(fleet);
  Scenario scenario{
      "skipped", "", {lost_task("bring", "ridgeback", {}), lost_task("carry", "", {0}), lost_task("grab", "ur3", {1})}};
  scenario.tasks[1].requires_ = {"mobile"};
  scenario.tasks[1].start_within_s = 12;
  scenario.tasks[1].on_failure = OnFailure::continue_;
  fleet["ur3"].adapter.endings = {{"grab", TaskOutcome::failed}};
  const UtcTime now = fleet.now().utc;
  fleet.ask("cloud", MessageType::command,
            RunSubmit{fleet.sign("cloud", kSignedRunStart,
                                 encode(build_run_start(scenario, fleet.members(), "cloud", now, now + seconds(3600),
                                                        kStoryRun, {"ridgeback", "cloud", "ur3"})))});
  const auto view = [&] { return fleet.view("cloud", kStoryRun); };
  REQUIRE(fleet.until([&] { return view().tasks[2].outcome == TaskOutcome::failed; }));
  REQUIRE(view().tasks[1].outcome == TaskOutcome::skipped);
  lose_journal_of_cloud(fleet);
  fleet.start("cloud");
  REQUIRE(fleet.until([&] { return view().run == kStoryRun; }));
  REQUIRE(fleet.until([&] { return view().state == RunState::paused; }, seconds(60)));
  CHECK(view().tasks[1].outcome == TaskOutcome::skipped);
  CHECK(view().waits_for.starts_with("task 'grab' failed"));
}

TEST_CASE("a cloud that lost its journal shows what has failed as failed, and never as due") {
  LossStory story;
  story.adapter("ur3").endings["grip"] = TaskOutcome::failed;
  story.adapter("ur3").skill_time = seconds(250);
  story.submit({lost_task("fly", "drone", {}), lost_task("grip", "ur3", {0})});
  REQUIRE(story.ends(RunState::paused));
  story.fleet.pass(seconds(1500));  // by now each asks every ten minutes only
  lose_journal_of_cloud(story.fleet);
  story.fleet.start("cloud");
  const auto view = [&] { return story.fleet.view("cloud", kStoryRun); };
  bool was_due = false;
  const auto has_failed = [&] {
    for (const TaskView& task : view().tasks) was_due = was_due || task.due;
    return view().run == kStoryRun && view().state == RunState::paused;
  };
  REQUIRE(story.fleet.until(has_failed, seconds(1400)));
  CHECK_FALSE(was_due);
  CHECK(view().tasks[1].outcome == TaskOutcome::failed);
}

TEST_CASE("a cloud that lost its journal and archive hears that a run was aborted from those that have it in theirs") {
  LossStory story;
  story.submit({lost_task("grip", "ur3", {}), lost_task("pack", "ur3", {0}), lost_task("fly", "drone", {1})});
  REQUIRE(story.begins(1));
  story.fleet["ur3"].cut = true;
  for (const char* node : {"cloud", "drone"}) {
    story.fleet.tell(node, node, MessageType::information, PeerExpired{"ur3", "cert_revoked: stolen"});
  }
  story.fleet.ask("cloud", MessageType::command, RunAbort{story.fleet.sign_order("cloud", kStoryRun)});
  REQUIRE(story.fleet.until([&] { return story.fleet["cloud"].archive->over(kStoryRun).has_value(); }));
  story.fleet.pass(seconds(120));
  lose_journal_of_cloud(story.fleet);
  story.fleet["cloud"].archive = std::make_unique<MemoryArchive>();
  story.fleet.start("cloud");
  story.fleet["ur3"].cut = false;
  story.fleet["drone"].cut = true;  // so that the UR's node is still alone with it
  REQUIRE(story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).run == kStoryRun; }, seconds(1400)));
  CHECK(story.fleet.view("cloud", kStoryRun).state != RunState::aborted);
  story.fleet["drone"].cut = false;
  const auto is_aborted = [&] {
    const RunState state = story.fleet.view("cloud", kStoryRun).state;
    return state == RunState::aborting || state == RunState::aborted;
  };
  CHECK(story.fleet.until(is_aborted, seconds(60)));
}
