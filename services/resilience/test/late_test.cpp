// A task that names no robot is due: the best robot is chosen, by the ranking of replacements.
#include <doctest/doctest.h>

#include <functional>

#include "services/resilience/test/fixture.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

/// t6 and t7 name no robot: any robot that drives may do them.
std::unique_ptr<Fixture> hall(ResilienceSettings settings = default_resilience(),
                              const std::function<void(Scenario&)>& change = {}) {
  auto fixture = paper(settings);
  for (const char* id : {"t6", "t7"}) {
    TaskView& of = fixture->task(id);
    Task& task = fixture->start.scenario.tasks[static_cast<std::size_t>(&of - fixture->view.tasks.data())];
    of.robot.clear();
    task.robot.clear();
    task.requires_ = {"mobile"};
  }
  if (change) change(fixture->start.scenario);
  fixture->restart();
  fixture->wait(seconds(6));
  return fixture;
}

/// The scheduler reports that the tasks are due.
void wants_robot(Fixture& fixture, const std::vector<std::string>& ids) {
  for (const std::string& id : ids) {
    fixture.task(id).outcome = TaskOutcome::released;
    fixture.task(id).attempt = 1;
  }
  fixture.changed();
  fixture.settle();
}

void tell(Fixture& fixture, const std::string& robot, double charge, double x, double y) {
  const std::string at = "[" + std::to_string(x) + ", " + std::to_string(y) + ", 0]";
  fixture.values[robot] = {{"battery", std::to_string(charge / 100)}, {"position", at}};
  fixture.say(robot, RobotState{{{"battery", std::to_string(charge / 100)}, {"position", at}}});
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
    auto fixture = hall();
    tell(*fixture, nearest, 90, 0.2, 0);
    wants_robot(*fixture, {"t7"});
    REQUIRE(fixture->taken.size() == 1);
    const Decision& decision = fixture->taken[0];
    CHECK(rulings(decision) == std::string("t7>") + nearest);
    CHECK(decision.person.empty());
    CHECK(decision.reason == "it names no robot: the best of 4");
    CHECK(fixture->task("t7").robot == nearest);
    CHECK(fixture->releases.empty());
    const Alert alert = fixture->any(decision.alert);
    CHECK(alert.state == AlertState::decided);
    CHECK(alert.cause == "robot_wanted");
    CHECK(alert.robot.empty());
    CHECK(alert.policy == "automatic");
    CHECK(alert.tasks == std::vector<std::string>{"t7"});
    CHECK(alert.proposals.front().parts.size() == 3);
    CHECK(fixture->alerts().empty());
  }
}

TEST_CASE("what the robots said is old: they are asked first, and their answers count") {
  auto fixture = hall();
  fixture->wait(seconds(60));
  fixture->values["pioneer2"] = {{"battery", "0.9"}, {"position", "[0.1, 0, 0]"}};
  fixture->values["turtlebot"].clear();  // it answers with nothing: that is an answer
  wants_robot(*fixture, {"t7"});
  REQUIRE(fixture->taken.size() == 1);
  CHECK(rulings(fixture->taken[0]) == "t7>pioneer2");
  CHECK(fixture->heard["position"] == 4);
}

TEST_CASE("the nearest was stopped a moment ago: the router is asked before anybody is chosen") {
  auto fixture = hall();
  tell(*fixture, "pioneer1", 90, 0.1, 0);
  tell(*fixture, "pioneer2", 90, 0.3, 0);
  fixture->routes["pioneer1"].profile.fenced = true;
  wants_robot(*fixture, {"t7"});
  CHECK(rulings(fixture->taken.at(0)) == "t7>pioneer2");
}

TEST_CASE("a robot that answers nothing is waited for, for 2 s") {
  auto fixture = hall();
  tell(*fixture, "pioneer1", 90, 0.1, 0);
  fixture->mute.insert("turtlebot");
  wants_robot(*fixture, {"t7"});
  CHECK(fixture->alert().policy == "automatic, waits: what turtlebot answers");
  fixture->wait(seconds(1));
  CHECK(fixture->taken.empty());
  fixture->wait(seconds(2));
  CHECK(rulings(fixture->taken.at(0)) == "t7>pioneer1");
}

TEST_CASE("two at once: one after the other, for who gets the first is less at hand for the second") {
  auto fixture = hall();
  tell(*fixture, "pioneer1", 80, 0.1, 0);
  tell(*fixture, "pioneer2", 80, 0.1, 0);
  wants_robot(*fixture, {"t6", "t7"});
  REQUIRE(fixture->taken.size() == 2);
  CHECK(fixture->taken[1].epoch == 3);
  CHECK(fixture->taken[1].previous.bytes == digest(fixture->decisions[0].payload.bytes));
  CHECK(fixture->task("t6").robot != fixture->task("t7").robot);
  for (const char* id : {"t6", "t7"}) CHECK(fixture->task(id).robot.starts_with("pioneer"));
}

TEST_CASE("nobody can do it: the alert stays open, is decided when somebody comes, and keeps no other task waiting") {
  auto fixture = hall(default_resilience(), [](Scenario& is) { is.tasks[5].requires_.emplace_back("swim"); });
  wants_robot(*fixture, {"t6", "t7"});
  fixture->wait(seconds(1500));
  REQUIRE(fixture->taken.size() == 1);
  CHECK(rulings(fixture->taken[0]).starts_with("t7>"));
  const Alert alert = fixture->alert();
  CHECK(alert.state == AlertState::open);
  CHECK(alert.proposals.empty());
  CHECK(alert.unfit.at(0).why.find("has no capability 'swim'") != std::string::npos);
  CHECK(alert.policy == "automatic, waits: no robot can do it now");
  CHECK(alert.waits_for.starts_with("a robot that can do task 't6', or a verdict: trb alert decide "));
  NodeProfile otter = mobile_robot();
  otter.capabilities.emplace_back("swim");
  fixture->add("otter", otter, 50, 0, 0);
  fixture->wait(seconds(6));
  REQUIRE(fixture->taken.size() == 2);
  CHECK(rulings(fixture->taken[1]) == "t6>otter");
  REQUIRE(fixture->taken[1].members.size() == 1);
  CHECK(fixture->taken[1].members[0].id == "otter");
  CHECK(fixture->alerts().empty());
}

TEST_CASE("a clock that is wrong for some seconds does not keep a task from the robot that comes later") {
  auto fixture = hall(default_resilience(), [](Scenario& is) { is.tasks[5].requires_.emplace_back("swim"); });
  wants_robot(*fixture, {"t6"});
  fixture->wait(seconds(60));
  fixture->put_clock(3600);
  fixture->wait(seconds(3));
  fixture->put_clock(0);
  fixture->wait(seconds(60));
  CHECK(fixture->alert().state == AlertState::open);
  NodeProfile otter = mobile_robot();
  otter.capabilities.emplace_back("swim");
  fixture->add("otter", otter, 50, 0, 0);
  fixture->wait(seconds(6));
  REQUIRE(fixture->taken.size() == 1);
  CHECK(rulings(fixture->taken[0]) == "t6>otter");
}

TEST_CASE("where people want to be asked they choose, skip or leave it; there is nothing to try again") {
  for (const Verdict verdict : {Verdict::accept, Verdict::override_, Verdict::skip}) {
    auto fixture = hall(asking());
    wants_robot(*fixture, {"t7"});
    fixture->wait(seconds(20));
    CHECK(fixture->taken.empty());
    CHECK(fixture->alert().policy == "ask");
    CHECK(fixture->decide(Verdict::retry) == "bad_value");
    const std::string robot = verdict == Verdict::skip ? "" : "turtlebot";
    const std::string id = fixture->alert().id;
    CHECK(fixture->decide(verdict, robot, false, "it is mine") == "accepted");
    CHECK(rulings(fixture->taken.at(0)) == (verdict == Verdict::skip ? "t7/cloud" : "t7>turtlebot"));
    CHECK(fixture->taken[0].person == "ann");
    CHECK(fixture->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "conflict");
  }
}

TEST_CASE("who was chosen fails: an alert about that robot, as for any task") {
  auto fixture = hall();
  tell(*fixture, "pioneer1", 90, 0.1, 0);
  wants_robot(*fixture, {"t7"});
  CHECK(fixture->task("t7").robot == "pioneer1");
  fixture->fault("pioneer1", "mobile");
  const Alert alert = fixture->alert();
  CHECK(alert.robot == "pioneer1");
  CHECK(alert.tasks == std::vector<std::string>{"t7"});
  CHECK(fixture->decide(Verdict::accept, "pioneer2") == "accepted");
  CHECK(rulings(fixture->taken.at(1)) == "t7>pioneer2");
}

TEST_CASE("the first robot of a task that names none is no move of the policy") {
  ResilienceSettings settings = automatic();
  settings.policy.max_moves = 1;
  auto fixture = hall(settings);
  wants_robot(*fixture, {"t7"});
  REQUIRE(fixture->taken.size() == 1);
  for (int i = 0; i < 2; ++i) {
    fixture->end_task("t7", TaskOutcome::failed, "stuck");
    fixture->wait(seconds(10));
    CHECK(fixture->taken.size() == 2);
  }
  CHECK(fixture->alert().policy == "automatic, but asks: it has moved task 't7' 1 times: a person decides");
}

TEST_CASE("a pinned task is bound, too") {
  auto fixture = hall(default_resilience(), [](Scenario& is) { is.tasks[6].pinned = true; });
  wants_robot(*fixture, {"t7"});
  CHECK(fixture->taken.size() == 1);
}

TEST_CASE("who is no decider shows it, and chooses nobody") {
  auto fixture = hall();
  fixture->settings.role = Role::robot;
  fixture->restart();
  fixture->wait(seconds(1));
  wants_robot(*fixture, {"t7"});
  fixture->wait(seconds(10));
  CHECK(fixture->alert().waits_for == "a verdict on node cloud");
  CHECK(fixture->taken.empty());
}

TEST_CASE("the task is skipped or the run over before anybody is chosen: the alert is closed") {
  auto fixture = hall(asking());
  wants_robot(*fixture, {"t7"});
  const std::string id = fixture->alert().id;
  fixture->task("t7").outcome = TaskOutcome::skipped;
  fixture->task("t7").state = TaskState::skipped;
  fixture->changed();
  fixture->settle();
  CHECK(fixture->any(id).state == AlertState::closed);
}

namespace {

std::size_t killed(std::size_t at) {
  auto fixture = hall();
  tell(*fixture, "pioneer2", 90, 0.1, 0);
  fixture->crash.commits = 0;
  fixture->crash.at = at;
  wants_robot(*fixture, {"t7"});
  fixture->wait(seconds(30));
  REQUIRE(fixture->taken.size() == 1);
  CHECK(rulings(fixture->taken[0]) == "t7>pioneer2");
  CHECK(fixture->alerts().empty());
  return fixture->crash.commits;
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
