// A task that names no robot is due: the best is chosen, by the ranking of replacements.
#include <doctest/doctest.h>

#include <functional>

#include "services/resilience/test/bench.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

/// t6 and t7 name no robot: whoever drives.
std::unique_ptr<Bench> hall(ResilienceSettings settings = default_resilience(),
                            const std::function<void(Scenario&)>& change = {}) {
  auto bench = paper(settings);
  for (const char* id : {"t6", "t7"}) {
    TaskView& of = bench->task(id);
    Task& task = bench->start.scenario.tasks[static_cast<std::size_t>(&of - bench->view.tasks.data())];
    of.robot.clear();
    task.robot.clear();
    task.requires_ = {"mobile"};
  }
  if (change) change(bench->start.scenario);
  bench->restart();
  bench->wait(seconds(6));
  return bench;
}

/// The scheduler says that the tasks are due.
void wants_robot(Bench& bench, const std::vector<std::string>& ids) {
  for (const std::string& id : ids) {
    bench.task(id).outcome = TaskOutcome::released;
    bench.task(id).attempt = 1;
  }
  bench.changed();
  bench.settle();
}

void tell(Bench& bench, const std::string& robot, double charge, double x, double y) {
  const std::string at = "[" + std::to_string(x) + ", " + std::to_string(y) + ", 0]";
  bench.values[robot] = {{"battery", std::to_string(charge / 100)}, {"position", at}};
  bench.say(robot, RobotState{{{"battery", std::to_string(charge / 100)}, {"position", at}}});
}

ResilienceSettings asking() {
  ResilienceSettings out = default_resilience();
  out.policy.asks_who_begins = true;
  return out;
}

}  // namespace

TEST_CASE("the nearest with a good battery is taken at once, whatever the policy asks people for") {
  for (const char* nearest : {"pioneer1", "pioneer2", "turtlebot"}) {
    CAPTURE(nearest);
    auto bench = hall();
    tell(*bench, nearest, 90, 0.2, 0);
    wants_robot(*bench, {"t7"});
    REQUIRE(bench->taken.size() == 1);
    const Decision& decision = bench->taken[0];
    CHECK(rulings(decision) == std::string("t7>") + nearest);
    CHECK(decision.person.empty());
    CHECK(decision.reason == "it names no robot: the best of 4");
    CHECK(bench->task("t7").robot == nearest);
    CHECK(bench->releases.empty());
    const Alert alert = bench->any(decision.alert);
    CHECK(alert.state == AlertState::decided);
    CHECK(alert.cause == "robot_wanted");
    CHECK(alert.robot.empty());
    CHECK(alert.policy == "automatic");
    CHECK(alert.tasks == std::vector<std::string>{"t7"});
    CHECK(alert.proposals.front().parts.size() == 3);
    CHECK(bench->alerts().empty());
  }
}

TEST_CASE("what the robots said is old: they are asked first, and their answers count") {
  auto bench = hall();
  bench->wait(seconds(60));
  bench->values["pioneer2"] = {{"battery", "0.9"}, {"position", "[0.1, 0, 0]"}};
  bench->values["turtlebot"].clear();  // it answers nothing: that is an answer
  wants_robot(*bench, {"t7"});
  REQUIRE(bench->taken.size() == 1);
  CHECK(rulings(bench->taken[0]) == "t7>pioneer2");
  CHECK(bench->heard["position"] == 4);
}

TEST_CASE("the nearest was stopped a moment ago: the router is asked before anybody is chosen") {
  auto bench = hall();
  tell(*bench, "pioneer1", 90, 0.1, 0);
  tell(*bench, "pioneer2", 90, 0.3, 0);
  bench->routes["pioneer1"].profile.fenced = true;
  wants_robot(*bench, {"t7"});
  CHECK(rulings(bench->taken.at(0)) == "t7>pioneer2");
}

TEST_CASE("a robot that answers nothing is waited for, for 2 s") {
  auto bench = hall();
  tell(*bench, "pioneer1", 90, 0.1, 0);
  bench->mute.insert("turtlebot");
  wants_robot(*bench, {"t7"});
  CHECK(bench->alert().policy == "automatic, waits: what turtlebot answers");
  bench->wait(seconds(1));
  CHECK(bench->taken.empty());
  bench->wait(seconds(2));
  CHECK(rulings(bench->taken.at(0)) == "t7>pioneer1");
}

TEST_CASE("two at once: one after the other, for who gets the first is less at hand for the second") {
  auto bench = hall();
  tell(*bench, "pioneer1", 80, 0.1, 0);
  tell(*bench, "pioneer2", 80, 0.1, 0);
  wants_robot(*bench, {"t6", "t7"});
  REQUIRE(bench->taken.size() == 2);
  CHECK(bench->taken[1].epoch == 3);
  CHECK(bench->taken[1].previous.bytes == digest(bench->decisions[0].payload.bytes));
  CHECK(bench->task("t6").robot != bench->task("t7").robot);
  for (const char* id : {"t6", "t7"}) CHECK(bench->task(id).robot.starts_with("pioneer"));
}

TEST_CASE("nobody can do it: the alert stays open, is decided when somebody comes, and keeps no other task waiting") {
  auto bench = hall(default_resilience(), [](Scenario& is) { is.tasks[5].requires_.emplace_back("swim"); });
  wants_robot(*bench, {"t6", "t7"});
  bench->wait(seconds(1500));
  REQUIRE(bench->taken.size() == 1);
  CHECK(rulings(bench->taken[0]).starts_with("t7>"));
  const Alert alert = bench->alert();
  CHECK(alert.state == AlertState::open);
  CHECK(alert.proposals.empty());
  CHECK(alert.unfit.at(0).why.find("has no capability 'swim'") != std::string::npos);
  CHECK(alert.policy == "automatic, waits: no robot can do it now");
  CHECK(alert.waits_for.starts_with("a robot that can do task 't6', or a verdict: trb alert decide "));
  NodeProfile otter = mobile_robot();
  otter.capabilities.emplace_back("swim");
  bench->add("otter", otter, 50, 0, 0);
  bench->wait(seconds(6));
  REQUIRE(bench->taken.size() == 2);
  CHECK(rulings(bench->taken[1]) == "t6>otter");
  REQUIRE(bench->taken[1].members.size() == 1);
  CHECK(bench->taken[1].members[0].id == "otter");
  CHECK(bench->alerts().empty());
}

TEST_CASE("where people want to be asked they choose, skip or leave it; there is nothing to try again") {
  for (const Verdict verdict : {Verdict::accept, Verdict::override_, Verdict::skip}) {
    auto bench = hall(asking());
    wants_robot(*bench, {"t7"});
    bench->wait(seconds(20));
    CHECK(bench->taken.empty());
    CHECK(bench->alert().policy == "ask");
    CHECK(bench->decide(Verdict::retry) == "bad_value");
    const std::string robot = verdict == Verdict::skip ? "" : "turtlebot";
    const std::string id = bench->alert().id;
    CHECK(bench->decide(verdict, robot, false, "it is mine") == "accepted");
    CHECK(rulings(bench->taken.at(0)) == (verdict == Verdict::skip ? "t7/cloud" : "t7>turtlebot"));
    CHECK(bench->taken[0].person == "ann");
    CHECK(bench->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "conflict");
  }
}

TEST_CASE("who was chosen fails: an alert about that robot, as for any task") {
  auto bench = hall();
  tell(*bench, "pioneer1", 90, 0.1, 0);
  wants_robot(*bench, {"t7"});
  CHECK(bench->task("t7").robot == "pioneer1");
  bench->fault("pioneer1", "mobile");
  const Alert alert = bench->alert();
  CHECK(alert.robot == "pioneer1");
  CHECK(alert.tasks == std::vector<std::string>{"t7"});
  CHECK(bench->decide(Verdict::accept, "pioneer2") == "accepted");
  CHECK(rulings(bench->taken.at(1)) == "t7>pioneer2");
}

TEST_CASE("the first robot of a task that names none is no move of the policy") {
  ResilienceSettings settings = automatic();
  settings.policy.max_moves = 1;
  auto bench = hall(settings);
  wants_robot(*bench, {"t7"});
  REQUIRE(bench->taken.size() == 1);
  for (int i = 0; i < 2; ++i) {
    bench->end_task("t7", TaskOutcome::failed, "stuck");
    bench->wait(seconds(10));
    CHECK(bench->taken.size() == 2);
  }
  CHECK(bench->alert().policy == "automatic, but asks: it has moved task 't7' 1 times: a person decides");
}

TEST_CASE("a pinned task is bound, too") {
  auto bench = hall(default_resilience(), [](Scenario& is) { is.tasks[6].pinned = true; });
  wants_robot(*bench, {"t7"});
  CHECK(bench->taken.size() == 1);
}

TEST_CASE("who is no decider shows it, and chooses nobody") {
  auto bench = hall();
  bench->settings.role = Role::robot;
  bench->restart();
  bench->wait(seconds(1));
  wants_robot(*bench, {"t7"});
  bench->wait(seconds(10));
  CHECK(bench->alert().waits_for == "a verdict on node cloud");
  CHECK(bench->taken.empty());
}

TEST_CASE("the task is skipped or the run over before anybody is chosen: the alert is closed") {
  auto bench = hall(asking());
  wants_robot(*bench, {"t7"});
  const std::string id = bench->alert().id;
  bench->task("t7").outcome = TaskOutcome::skipped;
  bench->task("t7").state = TaskState::skipped;
  bench->changed();
  bench->settle();
  CHECK(bench->any(id).state == AlertState::closed);
}

namespace {

std::size_t killed(std::size_t at) {
  auto bench = hall();
  tell(*bench, "pioneer2", 90, 0.1, 0);
  bench->commits = 0;
  bench->crash_at = at;
  wants_robot(*bench, {"t7"});
  bench->wait(seconds(30));
  REQUIRE(bench->taken.size() == 1);
  CHECK(rulings(bench->taken[0]) == "t7>pioneer2");
  CHECK(bench->alerts().empty());
  return bench->commits;
}

}  // namespace

TEST_CASE("killed after any of its commits the service still chooses once") {
  const std::size_t commits = killed(0);
  CHECK(commits >= 3);
  for (std::size_t at = 1; at <= commits; ++at) {
    CAPTURE(at);
    killed(at);
  }
}
