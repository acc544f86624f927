// The paper's section 6.1 and its variants, from the fault to the decision.
#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include "services/resilience/test/wheels_fail.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

TEST_CASE("the paper's story: Ridgeback cannot move any more, a Pioneer takes tasks 4 and 7, Ridgeback still loads") {
  auto fixture = paper();
  CHECK(fixture->alerts().empty());
  wheels_fail(*fixture);
  const Alert alert = fixture->alert();
  CHECK(alert.robot == "ridgeback");
  CHECK(alert.capability == "mobile");
  CHECK(alert.severity == Severity::critical);
  CHECK(alert.cause == "robot_fault");
  CHECK(alert.tasks == Words{"t4", "t7"});
  CHECK(alert.state == AlertState::open);
  CHECK_FALSE(alert.needs_word);
  CHECK(alert.name == "demonstration");
  // The TurtleBot has a task of its own, and the longest way.
  CHECK(robots_of(alert) == Words{"pioneer1", "pioneer2", "turtlebot"});
  double all = 0;
  for (const Proposal& one : alert.proposals) {
    double parts = 0;
    for (const CriterionPart& part : one.parts) parts += part.contribution;
    CHECK(parts == doctest::Approx(one.score));
    all += one.score;
  }
  CHECK(all == doctest::Approx(1));
  const auto& best = alert.proposals.front().parts;
  REQUIRE(best.size() == 3);
  CHECK(best[0].criterion == "battery");
  CHECK(best[0].value == doctest::Approx(80));
  CHECK(best[0].unit == "%");
  CHECK(best[1].value == doctest::Approx(3.1));
  CHECK(best[2].value == doctest::Approx(100));
  CHECK(alert.proposals[2].parts[2].value == doctest::Approx(50));

  CHECK(fixture->decide(Verdict::accept) == "accepted");
  REQUIRE(fixture->taken.size() == 1);
  const Decision& decision = fixture->taken.front();
  CHECK(rulings(decision) == "t4>pioneer1 t7>pioneer1");
  CHECK(decision.epoch == 2);
  CHECK(decision.previous.bytes.empty());
  CHECK(decision.alert == alert.id);
  CHECK(decision.person == "ann");
  REQUIRE(decision.members.size() == 1);
  CHECK(decision.members[0].id == "pioneer1");
  CHECK(decision.tasks[0].attempt == 2);
  // Task 4 had failed; only task 7 was to be given back.
  REQUIRE(fixture->releases.size() == 1);
  CHECK(fixture->releases[0].tasks == std::vector<std::uint16_t>{6});
  CHECK(fixture->task("t9").robot == "ridgeback");
  CHECK(fixture->alerts().empty());
  const Alert decided = fixture->any(alert.id);
  CHECK(decided.state == AlertState::decided);
  CHECK(decided.epoch == 2);
  fixture->wait(seconds(20));
  CHECK(fixture->taken.size() == 1);
  // No run needs the wheels any more; they are still broken.
  CHECK(fixture->alert().run.empty());
  CHECK(fixture->alert().capability == "mobile");
}

TEST_CASE("a fault and the task that fails of it are one alert, whichever is told first") {
  for (const bool fault_first : {true, false}) {
    auto fixture = paper();
    if (fault_first) fixture->fault("ridgeback", "mobile");
    fixture->end_task("t4", TaskOutcome::failed, "stuck");
    if (!fault_first) {
      CHECK(fixture->alert().cause == "task_failed");
      CHECK(fixture->alert().severity == Severity::urgent);
      CHECK(fixture->alert().tasks == Words{"t4"});
      fixture->wait(seconds(1));
      fixture->fault("ridgeback", "mobile");
    }
    fixture->wait(seconds(5));
    CHECK(fixture->alerts(true).size() == 1);
    CHECK(fixture->alert().cause == "robot_fault");
    CHECK(fixture->alert().tasks == Words{"t4", "t7"});
  }
}

TEST_CASE("what the robots said is old: they are asked, and the proposals follow their answers") {
  auto fixture = paper();
  fixture->wait(seconds(60));
  fixture->values["pioneer2"]["position"] = "[4, 0.5, 0]";
  wheels_fail(*fixture);
  CHECK(robots_of(fixture->alert()) == Words{"pioneer2", "pioneer1", "turtlebot"});
  CHECK(fixture->alert().proposals.front().note.empty());
  CHECK(fixture->heard["position"] == 3);
  CHECK(fixture->heard["battery"] == 3);
  // No robot is asked again and again; what a person has seen stays.
  fixture->values["pioneer2"]["position"] = "[40, 0, 0]";
  fixture->wait(seconds(20));
  CHECK(fixture->heard["position"] == 3);
  CHECK(robots_of(fixture->alert()).front() == "pioneer2");
}

TEST_CASE("nobody decides in time: the run stays paused, and can still be decided on new proposals") {
  auto fixture = paper();
  fixture->values.clear();  // the robots do not answer
  wheels_fail(*fixture);
  fixture->wait(seconds(601));
  Alert alert = fixture->alert();
  CHECK(alert.state == AlertState::expired);
  CHECK(fixture->view.state == RunState::paused);
  // The robots' values are ten minutes old.
  CHECK(alert.proposals.front().note.find("battery is 6") != std::string::npos);
  fixture->say("pioneer2", RobotState{{{"position", "[4, 0, 0]"}, {"battery", "0.9"}}});
  fixture->wait(Inquiry::kAgain);
  CHECK(robots_of(fixture->alert()).front() == "pioneer2");
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  CHECK(rulings(fixture->taken.at(0)) == "t4>pioneer2 t7>pioneer2");
}

TEST_CASE(
    "nobody has decided in time: new proposals that meet the policy's conditions are decided on without a person") {
  auto fixture = paper(automatic(0, 0.5));
  wheels_fail(*fixture);
  fixture->wait(seconds(620));
  CHECK(fixture->run_alert().state == AlertState::expired);
  CHECK(fixture->taken.empty());
  fixture->fault("pioneer2", "mobile");
  fixture->fault("turtlebot", "mobile");  // pioneer1 is left
  fixture->wait(seconds(20));
  std::set<std::string> decided;
  for (const Decision& one : fixture->taken) decided.insert(rulings(one) + one.person);
  CHECK(decided == std::set<std::string>{"t4>pioneer1 t7>pioneer1", "t6>pioneer1"});  // turtlebot's task, too
}

TEST_CASE("a fault that is over still explains the failed task, and is told as past; what was tried is told once") {
  auto fixture = paper();
  fixture->stand("ridgeback", "mobile");
  fixture->end_task("t4", TaskOutcome::failed, "mobile is broken");
  fixture->wait(seconds(6));
  const std::string fault = fixture->run_alert().text;
  CHECK(fixture->run_alert().cause == "robot_fault");
  fixture->unmended.insert("ridgeback");
  for (int i = 0; i < 3; ++i) {
    CHECK(fixture->decide(Verdict::retry) == "accepted");
    fixture->wait(seconds(6));
    CHECK(fixture->run_alert().text ==
          fault + "; tried in vain: ridgeback does not take it into use: the bumper is still pressed");
  }
  fixture->end_fault("ridgeback", "mobile");
  CHECK(fixture->run_alert().cause == "robot_fault");
  CHECK(fixture->run_alert().text == "no longer so: " + fault);
  fixture->stand("ridgeback", "mobile");
  CHECK(fixture->run_alert().text == fault);
}

TEST_CASE("a past cause gives way to a fault that stands, which is then what a repair is about") {
  auto fixture = paper();
  fixture->silence("ridgeback");
  fixture->end_task("t4", TaskOutcome::interrupted, "nobody knows");
  fixture->back("ridgeback");
  CHECK(fixture->run_alert().text == "no longer so: its node is not reached");
  fixture->say("ridgeback", RobotFault{"mobile", Severity::fatal, "the motor burns"});
  fixture->wait(seconds(3));
  const Alert alert = fixture->alert();  // no other one tells the fault
  CHECK(alert.run == kRun);
  CHECK(alert.cause == "robot_fault");
  CHECK(alert.capability == "mobile");
  CHECK(alert.severity == Severity::fatal);
  CHECK(alert.text == "the motor burns");
}

TEST_CASE("a fault that has outlived its run is over when somebody says so, though the alert is closed") {
  auto fixture = paper();
  wheels_fail(*fixture);
  const std::string id = fixture->alert().id;
  for (TaskView& task : fixture->view.tasks) task.state = TaskState::finished;
  fixture->view.state = RunState::finished;
  fixture->changed();
  CHECK(fixture->any(id).state == AlertState::closed);
  AlertDecide word;
  word.alert = id;
  word.verdict = Verdict::retry;
  word.person = "ann";
  CHECK(fixture->decide(word) == "accepted");
  CHECK(fixture->last_text.find("ridgeback is taken as mended") == 0);
  word.verdict = Verdict::skip;
  CHECK(fixture->decide(word) == "conflict");
}

TEST_CASE("a person does without: another robot with a reason, once more, left out, the end") {
  SUBCASE("override") {
    auto fixture = paper();
    wheels_fail(*fixture);
    CHECK(fixture->decide(Verdict::override_, "turtlebot") == "missing");
    CHECK(fixture->decide(Verdict::override_, "ur3", false, "it is near") == "bad_value");
    CHECK(fixture->decide(Verdict::override_, "ridgeback", false, "again") == "bad_value");
    CHECK(fixture->decide(Verdict::override_, "wall-e", false, "who else") == "unknown_target");
    CHECK(fixture->decide(Verdict::override_, "turtlebot", false, "it is wanted there") == "accepted");
    CHECK(rulings(fixture->taken.at(0)) == "t4>turtlebot t7>turtlebot");
    CHECK(fixture->taken[0].reason == "it is wanted there");
    CHECK(fixture->taken[0].members.empty());
  }
  SUBCASE("retry: the fault is over, says who repaired it") {
    auto fixture = paper();
    wheels_fail(*fixture);
    CHECK(fixture->decide(Verdict::retry) == "accepted");
    CHECK(rulings(fixture->taken.at(0)) == "t4!ridgeback");
    fixture->wait(seconds(10));
    CHECK(fixture->alerts().empty());
  }
  SUBCASE("retry of what has not failed: there is nothing to decide") {
    auto fixture = paper();
    fixture->fault("ridgeback", "mobile");
    const std::string id = fixture->alert().id;
    CHECK(fixture->decide(Verdict::retry) == "accepted");
    CHECK(fixture->taken.empty());
    CHECK(fixture->any(id).state == AlertState::closed);
  }
  SUBCASE("skip: what has failed; what cannot be done either is an alert of its own") {
    auto fixture = paper();
    wheels_fail(*fixture);
    CHECK(fixture->decide(Verdict::skip) == "accepted");
    CHECK(rulings(fixture->taken.at(0)) == "t4/cloud");
    CHECK(fixture->alert().tasks == Words{"t7"});
    CHECK(fixture->decide(Verdict::skip) == "accepted");
    CHECK(rulings(fixture->taken.at(1)) == "t7/cloud");
    CHECK(fixture->taken[1].previous.bytes == digest(fixture->decisions[0].payload.bytes));
  }
  SUBCASE("abort") {
    auto fixture = paper();
    wheels_fail(*fixture);
    const std::string id = fixture->alert().id;
    CHECK(fixture->decide(Verdict::abort) == "accepted");
    CHECK(fixture->view.state == RunState::aborted);
    CHECK(fixture->any(id).state == AlertState::decided);
    CHECK(fixture->taken.empty());
  }
}

TEST_CASE("nobody can take over: the alert says why not, and what is left to say") {
  auto fixture = paper();
  for (const char* robot : {"pioneer1", "pioneer2", "turtlebot"}) fixture->silence(robot);
  wheels_fail(*fixture);
  for (const Alert& alert : fixture->alerts()) {
    if (alert.robot != "ridgeback") continue;
    CHECK(alert.proposals.empty());
    REQUIRE(alert.unfit.size() == 3);
    CHECK(alert.unfit[0].robot == "pioneer1");
    CHECK(alert.unfit[0].why.find("not reached") != std::string::npos);
    CHECK(alert.waits_for.find("no robot can take over") != std::string::npos);
    CHECK(fixture->decide(AlertDecide{alert.id, Verdict::accept, "", "", "", false}) == "conflict");
  }
  fixture->back("pioneer2");
  fixture->wait(seconds(6));
  for (const Alert& alert : fixture->alerts()) {
    if (alert.robot == "ridgeback") CHECK(robots_of(alert) == Words{"pioneer2"});
  }
}

TEST_CASE("several take over between them if nobody can do all") {
  auto fixture = paper();
  fixture->add("loader", loader_robot(), 40, 0, 0);
  fixture->fault("ridgeback", "");
  fixture->end_task("t4", TaskOutcome::failed);
  const Alert alert = fixture->alert();
  REQUIRE(alert.proposals.size() == 1);
  CHECK(alert.proposals[0].robot.empty());
  CHECK(alert.proposals[0].score > 0);
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  CHECK(rulings(fixture->taken.at(0)) == "t4>pioneer1 t7>pioneer1 t9>loader");
  CHECK(fixture->taken[0].members.size() == 2);
}

TEST_CASE("a fault that no run minds is told, until somebody says that it is mended") {
  auto fixture = paper();
  fixture->fault("pioneer2", "mobile", Severity::urgent);
  fixture->wait(seconds(5));
  CHECK(fixture->alert().id.empty());  // only shown
  fixture->fault("pioneer2", "mobile");
  CHECK(fixture->alerts().empty());
  fixture->wait(seconds(3));
  const Alert alert = fixture->alert();
  CHECK(alert.run.empty());
  CHECK(alert.robot == "pioneer2");
  fixture->fault("pioneer2", "mobile");
  fixture->wait(seconds(3));
  CHECK(fixture->alerts().size() == 1);
  CHECK(fixture->decide(Verdict::skip) == "bad_value");
  CHECK(fixture->decide(Verdict::retry) == "accepted");
  CHECK(fixture->any(alert.id).state == AlertState::closed);
  // And it is proposed again.
  wheels_fail(*fixture);
  CHECK(robots_of(fixture->alert()) == Words{"pioneer1", "pioneer2", "turtlebot"});
  CHECK(fixture->decide(Verdict::accept) == "accepted");
}

TEST_CASE("a lesser fault is shown for a while, and starts nothing") {
  auto fixture = paper();
  fixture->fault("ridgeback", "mobile", Severity::warning);
  fixture->wait(seconds(5));
  const Alert shown = fixture->alert();
  CHECK(shown.id.empty());
  CHECK(shown.state == AlertState::closed);
  CHECK(shown.robot == "ridgeback");
  CHECK(shown.severity == Severity::warning);
  CHECK(shown.proposals.empty());
  CHECK(fixture->decide(Verdict::retry) != "accepted");
  fixture->wait(std::chrono::minutes(16));
  CHECK(fixture->alerts(true).empty());
}

TEST_CASE("after the decision a word says that the robot is mended") {
  auto fixture = paper();
  wheels_fail(*fixture);
  const std::string id = fixture->alert().id;
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  fixture->fault("pioneer1", "mobile");
  CHECK(robots_of(fixture->alert()) == Words{"pioneer2", "turtlebot"});
  CHECK(fixture->decide(AlertDecide{id, Verdict::retry, "", "", "new wheels", false}) == "accepted");
  CHECK(fixture->decide(AlertDecide{id, Verdict::skip, "", "", "", false}) == "conflict");
  fixture->fault("pioneer2", "mobile");
  fixture->wait(seconds(6));
  for (const Alert& alert : fixture->alerts()) {
    if (alert.robot != "pioneer1") continue;
    CHECK(robots_of(alert) == Words{"turtlebot"});
    REQUIRE(alert.unfit.size() == 2);
    CHECK(alert.unfit[1].why == "has failed task 't4' already");  // and nothing else
  }
}
