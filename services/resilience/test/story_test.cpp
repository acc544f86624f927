// The paper's section 6.1 and what may happen instead, told from the fault to the decision.
#include <doctest/doctest.h>

#include <cmath>

#include "services/resilience/test/bench.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

/// Ridgeback's wheels fail in task 4, and the task with them.
void wheels_fail(Bench& bench) {
  bench.fault("ridgeback", "mobile");
  bench.end_task("t4", TaskOutcome::failed, "mobile is broken");
}

}  // namespace

TEST_CASE("the paper's story: Ridgeback cannot move any more, a Pioneer takes tasks 4 and 7, Ridgeback still loads") {
  auto bench = paper();
  CHECK(bench->alerts().empty());
  wheels_fail(*bench);
  const Alert alert = bench->alert();
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

  CHECK(bench->decide(Verdict::accept) == "accepted");
  REQUIRE(bench->taken.size() == 1);
  const Decision& decision = bench->taken.front();
  CHECK(rulings(decision) == "t4>pioneer1 t7>pioneer1");
  CHECK(decision.epoch == 2);
  CHECK(decision.previous.bytes.empty());
  CHECK(decision.alert == alert.id);
  CHECK(decision.person == "ann");
  REQUIRE(decision.members.size() == 1);
  CHECK(decision.members[0].id == "pioneer1");
  CHECK(decision.tasks[0].attempt == 2);
  // Task 4 had failed; only task 7 was to be given back.
  REQUIRE(bench->releases.size() == 1);
  CHECK(bench->releases[0].tasks == std::vector<std::uint16_t>{6});
  CHECK(bench->task("t9").robot == "ridgeback");
  CHECK(bench->alerts().empty());
  const Alert decided = bench->any(alert.id);
  CHECK(decided.state == AlertState::decided);
  CHECK(decided.epoch == 2);
  bench->wait(seconds(20));
  CHECK(bench->taken.size() == 1);
  // No run minds the wheels any more; they are broken all the same.
  CHECK(bench->alert().run.empty());
  CHECK(bench->alert().capability == "mobile");
}

TEST_CASE("a fault and the task that fails of it are one alert, whichever is told first") {
  for (const bool fault_first : {true, false}) {
    auto bench = paper();
    if (fault_first) bench->fault("ridgeback", "mobile");
    bench->end_task("t4", TaskOutcome::failed, "stuck");
    if (!fault_first) {
      CHECK(bench->alert().cause == "task_failed");
      CHECK(bench->alert().severity == Severity::urgent);
      CHECK(bench->alert().tasks == Words{"t4"});
      bench->wait(seconds(1));
      bench->fault("ridgeback", "mobile");
    }
    bench->wait(seconds(5));
    CHECK(bench->alerts(true).size() == 1);
    CHECK(bench->alert().cause == "robot_fault");
    CHECK(bench->alert().tasks == Words{"t4", "t7"});
  }
}

TEST_CASE("what the robots said is old: they are asked, and the proposals follow their answers") {
  auto bench = paper();
  bench->wait(seconds(60));
  bench->values["pioneer2"]["position"] = "[4, 0.5, 0]";
  wheels_fail(*bench);
  CHECK(robots_of(bench->alert()) == Words{"pioneer2", "pioneer1", "turtlebot"});
  CHECK(bench->alert().proposals.front().note.empty());
  CHECK(bench->heard["position"] == 3);
  CHECK(bench->heard["battery"] == 3);
  // Nobody is asked again and again; what a person has seen stays.
  bench->values["pioneer2"]["position"] = "[40, 0, 0]";
  bench->wait(seconds(20));
  CHECK(bench->heard["position"] == 3);
  CHECK(robots_of(bench->alert()).front() == "pioneer2");
}

TEST_CASE("an automatic policy decides once the cause has shown all of its tasks") {
  auto bench = paper(automatic());
  bench->end_task("t4", TaskOutcome::failed, "stuck");
  bench->wait(seconds(1));
  bench->fault("ridgeback", "mobile");
  CHECK(bench->taken.empty());
  bench->wait(seconds(4));
  REQUIRE(bench->taken.size() == 1);
  CHECK(rulings(bench->taken[0]) == "t4>pioneer1 t7>pioneer1");
  CHECK(bench->taken[0].person.empty());
  CHECK(bench->any(bench->taken[0].alert).policy == "automatic");
}

TEST_CASE("an automatic policy waits for who is proposed to say how it is, for 5 s") {
  for (const bool answers : {true, false}) {
    auto bench = paper(automatic());
    bench->wait(seconds(60));
    bench->mute.insert("turtlebot");
    bench->fault("ridgeback", "mobile");
    bench->end_task("t4", TaskOutcome::failed, "stuck");
    bench->wait(seconds(4));
    CHECK(bench->alert().policy == "automatic, waits: what turtlebot answers");
    CHECK(bench->taken.empty());
    if (answers) {
      for (const auto& [name, value] : bench->values["turtlebot"]) bench->answer("turtlebot", Opaque{name, value});
    } else {
      bench->wait(seconds(2));
    }
    bench->wait(seconds(1));
    CHECK(bench->taken.size() == 1);
  }
}

TEST_CASE("a policy whose conditions do not hold asks, and says why") {
  const auto asks = [](ResilienceSettings settings) {
    auto bench = paper(settings);
    wheels_fail(*bench);
    bench->wait(seconds(10));
    CHECK(bench->taken.empty());
    return bench->alert().policy;
  };
  CHECK(asks(automatic(0.95)).starts_with("automatic, but asks: the best has a merit of 0.92"));
  CHECK(asks(automatic(0, 0.5)).starts_with("automatic, but asks: the best leads by"));
  ResilienceSettings mild = automatic();
  mild.policy.max_severity = Severity::urgent;
  CHECK(asks(mild) == "automatic, but asks: the fault is CRITICAL");
  CHECK(asks(default_resilience()) == "ask");
}

TEST_CASE("nobody decides in time: the run stays paused, and can still be decided on new proposals") {
  auto bench = paper();
  bench->values.clear();  // the robots do not answer
  wheels_fail(*bench);
  bench->wait(seconds(601));
  Alert alert = bench->alert();
  CHECK(alert.state == AlertState::expired);
  CHECK(bench->view.state == RunState::paused);
  // What the robots said is ten minutes old.
  CHECK(alert.proposals.front().note.find("battery is 6") != std::string::npos);
  bench->say("pioneer2", RobotState{{{"position", "[4, 0, 0]"}, {"battery", "0.9"}}});
  CHECK(robots_of(bench->alert()).front() == "pioneer2");
  CHECK(bench->decide(Verdict::accept) == "accepted");
  CHECK(rulings(bench->taken.at(0)) == "t4>pioneer2 t7>pioneer2");
}

TEST_CASE("a robot that falls silent: its tasks move on a person's word alone") {
  auto bench = paper(automatic());
  bench->silence("ridgeback");
  const Alert alert = bench->alert();
  CHECK(alert.cause == "peer_expired");
  CHECK(alert.capability.empty());
  CHECK(alert.tasks == Words{"t4", "t7", "t9"});
  CHECK(alert.needs_word);
  CHECK(alert.unfit.size() >= 1);
  CHECK(alert.proposals.empty());  // nobody else loads
  bench->add("husky", carrier(), 50, 0, 0);
  bench->wait(seconds(10));
  CHECK(bench->taken.empty());
  CHECK(bench->alert().policy == "automatic, but asks: only a person can say that ridgeback stands");
  CHECK(bench->decide(Verdict::accept) == "bad_value");
  CHECK(bench->last_text.find("--stands") != std::string::npos);
  CHECK(bench->decide(Verdict::accept, "husky", true) == "accepted");
  CHECK(rulings(bench->taken.at(0)) == "t4>husky? t7>husky? t9>husky?");
  CHECK(bench->releases.empty());
}

TEST_CASE("a robot that comes back before anything was decided closes its alert; one whose task has failed does not") {
  auto bench = paper();
  bench->silence("ridgeback");
  const std::string id = bench->alert().id;
  bench->back("ridgeback");
  CHECK(bench->alerts().empty());
  CHECK(bench->any(id).state == AlertState::closed);

  bench->silence("ridgeback");
  bench->end_task("t4", TaskOutcome::interrupted, "nobody knows");
  bench->back("ridgeback");
  const Alert alert = bench->alert();
  CHECK(alert.tasks == Words{"t4"});
  CHECK(alert.needs_word);
  // go_to may be done twice: the robot may try again without a word.
  CHECK(bench->decide(Verdict::retry) == "accepted");
  CHECK(rulings(bench->taken.at(0)) == "t4!ridgeback");
}

TEST_CASE("a connection that is broken for less than the grace is no alert") {
  auto bench = paper();
  const auto connection = [&](const std::string& state) {
    bench->routes["ridgeback"].profile.robot = state;
    bench->say("ridgeback", RobotConnection{state, ""});
  };
  connection("CONNECTION_BROKEN");
  bench->wait(seconds(4));
  connection("ONLINE");
  bench->wait(seconds(20));
  CHECK(bench->alerts(true).empty());
  connection("CONNECTION_BROKEN");
  bench->wait(seconds(6));
  CHECK(bench->alert().cause == "robot_connection");
  CHECK_FALSE(bench->alert().needs_word);  // its node can still give tasks back
  connection("ONLINE");
  CHECK(bench->alerts().empty());
}

TEST_CASE("a robot that is back before the grace is over is no alert, though nobody heard it say so") {
  auto bench = paper();
  bench->routes["ridgeback"].profile.robot = "";  // its router was started anew, before its mode-adapter had told it
  bench->say("cloud", PeerJoined{"ridgeback", 2});
  bench->wait(seconds(2));
  bench->routes["ridgeback"].profile.robot = "ONLINE";
  bench->wait(seconds(20));
  CHECK(bench->alerts(true).empty());
}

TEST_CASE("a fault that has outlived its run is over when somebody says so, though the alert is closed") {
  auto bench = paper();
  wheels_fail(*bench);
  const std::string id = bench->alert().id;
  for (TaskView& task : bench->view.tasks) task.state = TaskState::finished;
  bench->view.state = RunState::finished;
  bench->changed();
  CHECK(bench->any(id).state == AlertState::closed);
  AlertDecide word;
  word.alert = id;
  word.verdict = Verdict::retry;
  word.person = "ann";
  CHECK(bench->decide(word) == "accepted");
  CHECK(bench->last_text.find("ridgeback is taken as mended") == 0);
  word.verdict = Verdict::skip;
  CHECK(bench->decide(word) == "conflict");
}

TEST_CASE("a person does without: another robot with a reason, once more, left out, the end") {
  SUBCASE("override") {
    auto bench = paper();
    wheels_fail(*bench);
    CHECK(bench->decide(Verdict::override_, "turtlebot") == "missing");
    CHECK(bench->decide(Verdict::override_, "ur3", false, "it is near") == "bad_value");
    CHECK(bench->decide(Verdict::override_, "ridgeback", false, "again") == "bad_value");
    CHECK(bench->decide(Verdict::override_, "wall-e", false, "who else") == "unknown_target");
    CHECK(bench->decide(Verdict::override_, "turtlebot", false, "it is wanted there") == "accepted");
    CHECK(rulings(bench->taken.at(0)) == "t4>turtlebot t7>turtlebot");
    CHECK(bench->taken[0].reason == "it is wanted there");
    CHECK(bench->taken[0].members.empty());
  }
  SUBCASE("retry: the fault is over, says who repaired it") {
    auto bench = paper();
    wheels_fail(*bench);
    CHECK(bench->decide(Verdict::retry) == "accepted");
    CHECK(rulings(bench->taken.at(0)) == "t4!ridgeback");
    bench->wait(seconds(10));
    CHECK(bench->alerts().empty());
  }
  SUBCASE("retry of what has not failed: there is nothing to decide") {
    auto bench = paper();
    bench->fault("ridgeback", "mobile");
    const std::string id = bench->alert().id;
    CHECK(bench->decide(Verdict::retry) == "accepted");
    CHECK(bench->taken.empty());
    CHECK(bench->any(id).state == AlertState::closed);
  }
  SUBCASE("skip: what has failed; what cannot be done either is an alert of its own") {
    auto bench = paper();
    wheels_fail(*bench);
    CHECK(bench->decide(Verdict::skip) == "accepted");
    CHECK(rulings(bench->taken.at(0)) == "t4/cloud");
    CHECK(bench->alert().tasks == Words{"t7"});
    CHECK(bench->decide(Verdict::skip) == "accepted");
    CHECK(rulings(bench->taken.at(1)) == "t7/cloud");
    CHECK(bench->taken[1].previous.bytes == digest(bench->decisions[0].payload.bytes));
  }
  SUBCASE("abort") {
    auto bench = paper();
    wheels_fail(*bench);
    const std::string id = bench->alert().id;
    CHECK(bench->decide(Verdict::abort) == "accepted");
    CHECK(bench->view.state == RunState::aborted);
    CHECK(bench->any(id).state == AlertState::decided);
    CHECK(bench->taken.empty());
  }
}

TEST_CASE("nobody can take over: the alert says why not, and what is left to say") {
  auto bench = paper();
  for (const char* robot : {"pioneer1", "pioneer2", "turtlebot"}) bench->silence(robot);
  wheels_fail(*bench);
  for (const Alert& alert : bench->alerts()) {
    if (alert.robot != "ridgeback") continue;
    CHECK(alert.proposals.empty());
    REQUIRE(alert.unfit.size() == 3);
    CHECK(alert.unfit[0].robot == "pioneer1");
    CHECK(alert.unfit[0].why.find("not reached") != std::string::npos);
    CHECK(alert.waits_for.find("no robot can take over") != std::string::npos);
    CHECK(bench->decide(AlertDecide{alert.id, Verdict::accept, "", "", "", false}) == "conflict");
  }
  bench->back("pioneer2");
  bench->wait(seconds(6));
  for (const Alert& alert : bench->alerts()) {
    if (alert.robot == "ridgeback") CHECK(robots_of(alert) == Words{"pioneer2"});
  }
}

TEST_CASE("several take over between them if nobody can do all") {
  auto bench = paper();
  bench->add("loader", loader_robot(), 40, 0, 0);
  bench->fault("ridgeback", "");
  bench->end_task("t4", TaskOutcome::failed);
  const Alert alert = bench->alert();
  REQUIRE(alert.proposals.size() == 1);
  CHECK(alert.proposals[0].robot.empty());
  CHECK(alert.proposals[0].score > 0);
  CHECK(bench->decide(Verdict::accept) == "accepted");
  CHECK(rulings(bench->taken.at(0)) == "t4>pioneer1 t7>pioneer1 t9>loader");
  CHECK(bench->taken[0].members.size() == 2);
}

TEST_CASE("a fault that no run minds is told, until somebody says that it is mended") {
  auto bench = paper();
  bench->fault("pioneer2", "mobile", Severity::urgent);
  bench->wait(seconds(5));
  CHECK(bench->alert().id.empty());  // shown, and no more
  bench->fault("pioneer2", "mobile");
  CHECK(bench->alerts().empty());
  bench->wait(seconds(3));
  const Alert alert = bench->alert();
  CHECK(alert.run.empty());
  CHECK(alert.robot == "pioneer2");
  bench->fault("pioneer2", "mobile");
  bench->wait(seconds(3));
  CHECK(bench->alerts().size() == 1);
  CHECK(bench->decide(Verdict::skip) == "bad_value");
  CHECK(bench->decide(Verdict::retry) == "accepted");
  CHECK(bench->any(alert.id).state == AlertState::closed);
  // And it is proposed again.
  wheels_fail(*bench);
  CHECK(robots_of(bench->alert()) == Words{"pioneer1", "pioneer2", "turtlebot"});
  CHECK(bench->decide(Verdict::accept) == "accepted");
}

TEST_CASE("a lesser fault is shown for a while, and starts nothing") {
  auto bench = paper();
  bench->fault("ridgeback", "mobile", Severity::warning);
  bench->wait(seconds(5));
  const Alert shown = bench->alert();
  CHECK(shown.id.empty());
  CHECK(shown.state == AlertState::closed);
  CHECK(shown.robot == "ridgeback");
  CHECK(shown.severity == Severity::warning);
  CHECK(shown.proposals.empty());
  CHECK(bench->decide(Verdict::retry) != "accepted");
  bench->wait(std::chrono::minutes(16));
  CHECK(bench->alerts(true).empty());
}

TEST_CASE("after the decision a word says that the robot is mended") {
  auto bench = paper();
  wheels_fail(*bench);
  const std::string id = bench->alert().id;
  CHECK(bench->decide(Verdict::accept) == "accepted");
  bench->fault("pioneer1", "mobile");
  CHECK(robots_of(bench->alert()) == Words{"pioneer2", "turtlebot"});
  CHECK(bench->decide(AlertDecide{id, Verdict::retry, "", "", "new wheels", false}) == "accepted");
  CHECK(bench->decide(AlertDecide{id, Verdict::skip, "", "", "", false}) == "conflict");
  bench->fault("pioneer2", "mobile");
  bench->wait(seconds(6));
  for (const Alert& alert : bench->alerts()) {
    if (alert.robot != "pioneer1") continue;
    CHECK(robots_of(alert) == Words{"turtlebot"});
    REQUIRE(alert.unfit.size() == 2);
    CHECK(alert.unfit[1].why == "has failed task 't4' already");  // and nothing else
  }
}
