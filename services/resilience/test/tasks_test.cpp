// Verdicts by task: for some of an alert's, or for tasks without an alert; what is pinned, done twice, or stuck.
#include <doctest/doctest.h>

#include <algorithm>

#include "services/resilience/test/fixture.hpp"
#include "services/resilience/test/wheels_fail.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

std::unique_ptr<Fixture> pinned(const Words& ids) {
  auto fixture = paper();
  for (const std::string& id : ids) {
    fixture->start.scenario.tasks[static_cast<std::size_t>(&fixture->task(id) - fixture->view.tasks.data())].pinned =
        true;
  }
  fixture->restart();
  fixture->wait(seconds(6));
  return fixture;
}

std::string decide_on(Fixture& fixture, const Words& tasks, Verdict verdict, const std::string& robot = "",
                      const std::string& reason = "") {
  AlertDecide word;
  word.alert = fixture.run_alert().id;
  word.verdict = verdict;
  word.robot = robot;
  word.reason = reason;
  word.tasks = tasks;
  return fixture.decide(word);
}

AlertDecide of_run(const Words& tasks, Verdict verdict, const std::string& robot = "") {
  AlertDecide out;
  out.run = kRun.substr(0, 8);
  out.tasks = tasks;
  out.verdict = verdict;
  out.robot = robot;
  out.reason = "it is nearer";
  return out;
}

}  // namespace

TEST_CASE("some of an alert's tasks are decided on; the others come back as an alert of their own") {
  auto fixture = paper();
  wheels_fail(*fixture);
  const std::string first = fixture->run_alert().id;
  CHECK(decide_on(*fixture, {"t1"}, Verdict::accept) == "bad_value");
  CHECK(decide_on(*fixture, {"t4", "nothing"}, Verdict::accept) == "bad_value");
  CHECK(decide_on(*fixture, {"t4"}, Verdict::abort) == "bad_value");
  CHECK(fixture->run_alert().tasks == Words{"t4", "t7"});
  CHECK(decide_on(*fixture, {"t4"}, Verdict::skip) == "accepted");
  CHECK(rulings(fixture->taken.at(0)) == "t4/cloud");
  const Alert rest = fixture->run_alert();
  CHECK(rest.id != first);
  CHECK(rest.tasks == Words{"t7"});
  CHECK(fixture->any(first).tasks == Words{"t4"});
  CHECK(decide_on(*fixture, {"t7"}, Verdict::accept, "turtlebot") == "accepted");
  CHECK(rulings(fixture->taken.at(1)) == "t7>turtlebot");
  CHECK(fixture->run_alerts().empty());
}

TEST_CASE("who can do only some of the tasks is proposed for those") {
  auto fixture = paper();
  fixture->add("loader", loader_robot(), 40, 0, 0);
  fixture->fault("ridgeback", "");
  fixture->end_task("t4", TaskOutcome::failed);
  CHECK(fixture->run_alert().proposals.at(0).robot.empty());
  CHECK(decide_on(*fixture, {"t4"}, Verdict::accept, "pioneer2") == "accepted");
  CHECK(rulings(fixture->taken.at(0)) == "t4>pioneer2");
}

TEST_CASE("one pinned task takes the proposals from none of the others, and stays with the words that it is pinned") {
  for (const Verdict verdict : {Verdict::accept, Verdict::override_}) {
    auto fixture = pinned({"t7"});
    fixture->fault("ridgeback", "");
    fixture->add("husky", carrier(), 50, 0, 0);
    fixture->end_task("t4", TaskOutcome::failed, "stuck");
    fixture->wait(seconds(6));
    const Alert alert = fixture->run_alert();
    CHECK(alert.tasks == Words{"t4", "t7", "t9"});
    REQUIRE(alert.proposals.size() == 1);
    REQUIRE(alert.proposals[0].tasks.size() == 2);
    CHECK(alert.unfit.at(0).why == "task 't7' is pinned to it: it stays, for --retry or --skip");
    CHECK(decide_on(*fixture, {"t7"}, verdict, "husky", "go") == "conflict");
    CHECK(decide_on(*fixture, {"t4", "t7"}, verdict, "husky", "go") == "conflict");
    CHECK(decide_on(*fixture, {}, verdict, "husky", "go") == "accepted");
    CHECK(rulings(fixture->taken.at(0)) == "t4>husky t9>husky");
    const Alert rest = fixture->run_alert();
    CHECK(rest.tasks == Words{"t7"});
    CHECK(rest.proposals.empty());
    CHECK(fixture->decide(Verdict::accept) == "conflict");
    CHECK(fixture->decide(Verdict::skip) == "accepted");
    CHECK(rulings(fixture->taken.at(1)) == "t7/cloud");
  }
}

TEST_CASE("a policy moves what may move, and asks about what is pinned") {
  auto fixture = pinned({"t7"});
  fixture->settings.resilience = automatic();
  fixture->restart();
  fixture->wait(seconds(6));
  wheels_fail(*fixture);
  fixture->wait(seconds(20));
  REQUIRE(fixture->taken.size() == 1);
  CHECK(rulings(fixture->taken[0]) == "t4>pioneer1");
  CHECK(fixture->run_alert().tasks == Words{"t7"});
  CHECK(fixture->run_alert().policy == "automatic, but asks: no robot can take over");
}

TEST_CASE("any task can be moved or skipped without an alert: one is made and decided in the same step") {
  auto fixture = paper();
  CHECK(fixture->decide(of_run({"t7"}, Verdict::override_, "pioneer2")) == "accepted");
  CHECK(rulings(fixture->taken.at(0)) == "t7>pioneer2");
  const Alert alert = fixture->any(fixture->taken[0].alert);
  CHECK(alert.cause == "asked");
  CHECK(alert.state == AlertState::decided);
  CHECK(alert.text == "asked by 'ann': it is nearer");
  CHECK(fixture->taken[0].person == "ann");
  CHECK(fixture->decide(of_run({"t6"}, Verdict::accept)) == "accepted");
  CHECK(rulings(fixture->taken.at(1)) == "t6>ridgeback");  // it stands nearest
  CHECK(fixture->decide(of_run({"t9", "t9"}, Verdict::skip)) == "accepted");
  CHECK(rulings(fixture->taken.at(2)) == "t9/cloud");
  CHECK(fixture->alerts().empty());
  CHECK(fixture->alerts(true).size() == 3);  // a task given back for a verdict is no failure
}

TEST_CASE("a word on a task that makes no sense is refused, with the cure, and leaves nothing behind") {
  auto fixture = paper();
  const auto refused = [&](AlertDecide word) {
    const std::string code = fixture->decide(std::move(word));
    CHECK(fixture->last_text.find(" | ") + 3 < fixture->last_text.size());
    return code;
  };
  CHECK(refused(of_run({}, Verdict::skip)) == "missing");
  CHECK(refused(of_run({"t99"}, Verdict::skip)) == "bad_value");
  CHECK(refused(of_run({"t1"}, Verdict::skip)) == "conflict");
  CHECK(refused(of_run({"t6", "t7"}, Verdict::skip)) == "bad_value");
  CHECK(refused(of_run({"t7"}, Verdict::retry)) == "conflict");
  CHECK(refused(of_run({"t7"}, Verdict::none)) == "missing");
  CHECK(refused(of_run({"t7"}, Verdict::override_, "ur3")) == "bad_value");
  CHECK(refused(of_run({"t7"}, Verdict::accept, "ur3")) == "bad_value");
  AlertDecide unknown = of_run({"t7"}, Verdict::skip);
  unknown.run = "ffff";
  CHECK(refused(unknown) == "unknown_run");
  AlertDecide both = of_run({"t7"}, Verdict::skip);
  both.alert = "00";
  CHECK(refused(both) == "bad_value");
  CHECK(fixture->alerts(true).empty());
  CHECK(fixture->taken.empty());
}

TEST_CASE("tasks of which an open alert tells are decided on there") {
  auto fixture = paper();
  wheels_fail(*fixture);
  const std::string id = fixture->run_alert().id;
  CHECK(fixture->decide(of_run({"t4", "t9"}, Verdict::skip)) == "conflict");
  CHECK(fixture->decide(of_run({"t4"}, Verdict::skip)) == "accepted");
  CHECK(fixture->taken.at(0).alert == id);
  CHECK(fixture->run_alert().tasks == Words{"t7"});
}

TEST_CASE("what was done twice is told until the run goes on: nothing is moved, tried again or skipped") {
  auto fixture = paper();
  fixture->task("t3").twice = true;
  fixture->changed();
  fixture->wait(seconds(2));
  CHECK(fixture->alerts().empty());  // a person has resumed the run
  fixture->view.paused_by = "cloud";
  fixture->view.state = RunState::paused;
  fixture->changed();
  fixture->wait(seconds(2));
  const Alert alert = fixture->alert();
  CHECK(alert.cause == "double_execution");
  CHECK(alert.severity == Severity::critical);
  CHECK(alert.robot == "ur3");
  CHECK(alert.tasks == Words{"t3"});
  CHECK(alert.proposals.empty());
  CHECK(alert.text.find("trb scenario resume 01234567") != std::string::npos);
  for (const Verdict verdict : {Verdict::accept, Verdict::override_, Verdict::retry, Verdict::skip}) {
    CHECK(fixture->decide(verdict, "ur3", true, "x") == "conflict");
    CHECK(fixture->last_text.find("trb scenario resume 01234567") != std::string::npos);
  }
  fixture->wait(seconds(700));
  CHECK(fixture->alert().state == AlertState::open);
  SUBCASE("looked at, and on it goes") {
    fixture->view.paused_by.clear();
    fixture->changed();
    fixture->wait(seconds(2));
    CHECK(fixture->any(alert.id).state == AlertState::closed);
    CHECK(fixture->alerts().empty());
  }
  SUBCASE("the end") {
    CHECK(fixture->decide(Verdict::abort) == "accepted");
    CHECK(fixture->view.state == RunState::aborted);
    CHECK(fixture->alerts().empty());
  }
}

TEST_CASE("a robot that gives nothing back for 30 s: it is said, and another verdict is taken") {
  for (const bool stands : {true, false}) {
    auto fixture = paper();
    wheels_fail(*fixture);
    fixture->keeps.insert("ridgeback");
    CHECK(fixture->decide(Verdict::accept) == "accepted");
    fixture->wait(seconds(28));
    CHECK(fixture->decide(Verdict::accept, "pioneer2") == "conflict");
    fixture->wait(seconds(3));
    CHECK(fixture->run_alert().waits_for.starts_with(
        "ridgeback to give task 't7' back; it has been waited for for 30 s"));
    const std::size_t asked = fixture->releases.size();
    if (stands) {
      CHECK(fixture->decide(Verdict::accept, "pioneer2", true) == "accepted");
      fixture->wait(seconds(6));
      REQUIRE(fixture->taken.size() == 1);
      CHECK(rulings(fixture->taken.at(0)) == "t4>pioneer2 t7>pioneer2?");
      continue;
    }
    CHECK(fixture->decide(Verdict::override_, "ridgeback", false, "again") == "bad_value");
    CHECK(fixture->run_alert().proposals.front().robot == "pioneer1");  // the earlier verdict still holds
    CHECK(fixture->run_alert().state == AlertState::releasing);
    CHECK(fixture->decide(Verdict::accept, "pioneer2") == "accepted");
    CHECK(fixture->releases.size() == asked + 1);  // asked at once, before the next resend was due
    fixture->keeps.clear();
    fixture->wait(seconds(2));
    CHECK(rulings(fixture->taken.at(0)) == "t4>pioneer2 t7>pioneer2");
  }
}

TEST_CASE("decided anew it is on proposals of now, not on an override that did not come about") {
  auto fixture = paper();
  fixture->task("t4").failed_by = {"pioneer1"};
  fixture->changed();
  fixture->settle();
  wheels_fail(*fixture);
  fixture->keeps.insert("ridgeback");
  CHECK(fixture->decide(Verdict::override_, "pioneer1", false, "it was cleaned") == "accepted");
  fixture->wait(seconds(31));
  CHECK(fixture->decide(Verdict::accept, "pioneer1") == "bad_value");
  CHECK(fixture->run_alert().verdict == Verdict::override_);
}

TEST_CASE("a task that its robot has given back is somebody else's, though nothing else is the matter") {
  auto fixture = paper();
  fixture->task("t7").outcome = TaskOutcome::released;
  fixture->task("t7").attempt = 1;
  fixture->changed();
  fixture->settle();
  CHECK(fixture->view.state == RunState::running);
  CHECK(fixture->alert().tasks == Words{"t7"});
  CHECK(fixture->alert().cause == "task_failed");
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  CHECK(rulings(fixture->taken.at(0)) == "t7>pioneer1");
}
