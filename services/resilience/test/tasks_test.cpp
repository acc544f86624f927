// Verdicts by task: some of an alert's, or tasks of which no alert tells; what is pinned, done twice, or stuck.
#include <doctest/doctest.h>

#include <algorithm>

#include "services/resilience/test/bench.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

std::unique_ptr<Bench> pinned(const Words& ids) {
  auto bench = paper();
  for (const std::string& id : ids) {
    bench->start.scenario.tasks[static_cast<std::size_t>(&bench->task(id) - bench->view.tasks.data())].pinned = true;
  }
  bench->restart();
  bench->wait(seconds(6));
  return bench;
}

void wheels_fail(Bench& bench) {
  bench.fault("ridgeback", "mobile");
  bench.end_task("t4", TaskOutcome::failed, "mobile is broken");
}

std::string decide_on(Bench& bench, const Words& tasks, Verdict verdict, const std::string& robot = "",
                      const std::string& reason = "") {
  AlertDecide word;
  word.alert = bench.run_alert().id;
  word.verdict = verdict;
  word.robot = robot;
  word.reason = reason;
  word.tasks = tasks;
  return bench.decide(word);
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
  auto bench = paper();
  wheels_fail(*bench);
  const std::string first = bench->run_alert().id;
  CHECK(decide_on(*bench, {"t1"}, Verdict::accept) == "bad_value");
  CHECK(decide_on(*bench, {"t4", "nothing"}, Verdict::accept) == "bad_value");
  CHECK(decide_on(*bench, {"t4"}, Verdict::abort) == "bad_value");
  CHECK(bench->run_alert().tasks == Words{"t4", "t7"});
  CHECK(decide_on(*bench, {"t4"}, Verdict::skip) == "accepted");
  CHECK(rulings(bench->taken.at(0)) == "t4/cloud");
  const Alert rest = bench->run_alert();
  CHECK(rest.id != first);
  CHECK(rest.tasks == Words{"t7"});
  CHECK(bench->any(first).tasks == Words{"t4"});
  CHECK(decide_on(*bench, {"t7"}, Verdict::accept, "turtlebot") == "accepted");
  CHECK(rulings(bench->taken.at(1)) == "t7>turtlebot");
  CHECK(bench->run_alerts().empty());
}

TEST_CASE("who can do only some of the tasks is proposed for those") {
  auto bench = paper();
  bench->add("loader", loader_robot(), 40, 0, 0);
  bench->fault("ridgeback", "");
  bench->end_task("t4", TaskOutcome::failed);
  CHECK(bench->run_alert().proposals.at(0).robot.empty());
  CHECK(decide_on(*bench, {"t4"}, Verdict::accept, "pioneer2") == "accepted");
  CHECK(rulings(bench->taken.at(0)) == "t4>pioneer2");
}

TEST_CASE("one pinned task takes the proposals from none of the others, and stays with the words that it is pinned") {
  for (const Verdict verdict : {Verdict::accept, Verdict::override_}) {
    auto bench = pinned({"t7"});
    bench->fault("ridgeback", "");
    bench->add("husky", carrier(), 50, 0, 0);
    bench->end_task("t4", TaskOutcome::failed, "stuck");
    bench->wait(seconds(6));
    const Alert alert = bench->run_alert();
    CHECK(alert.tasks == Words{"t4", "t7", "t9"});
    REQUIRE(alert.proposals.size() == 1);
    REQUIRE(alert.proposals[0].tasks.size() == 2);
    CHECK(alert.unfit.at(0).why == "task 't7' is pinned to it: it stays, for --retry or --skip");
    CHECK(decide_on(*bench, {"t7"}, verdict, "husky", "go") == "conflict");
    CHECK(decide_on(*bench, {"t4", "t7"}, verdict, "husky", "go") == "conflict");
    CHECK(decide_on(*bench, {}, verdict, "husky", "go") == "accepted");
    CHECK(rulings(bench->taken.at(0)) == "t4>husky t9>husky");
    const Alert rest = bench->run_alert();
    CHECK(rest.tasks == Words{"t7"});
    CHECK(rest.proposals.empty());
    CHECK(bench->decide(Verdict::accept) == "conflict");
    CHECK(bench->decide(Verdict::skip) == "accepted");
    CHECK(rulings(bench->taken.at(1)) == "t7/cloud");
  }
}

TEST_CASE("a policy moves what may move, and asks about what is pinned") {
  auto bench = pinned({"t7"});
  bench->settings.resilience = automatic();
  bench->restart();
  bench->wait(seconds(6));
  wheels_fail(*bench);
  bench->wait(seconds(20));
  REQUIRE(bench->taken.size() == 1);
  CHECK(rulings(bench->taken[0]) == "t4>pioneer1");
  CHECK(bench->run_alert().tasks == Words{"t7"});
  CHECK(bench->run_alert().policy == "automatic, but asks: no robot can take over");
}

TEST_CASE("any task can be moved or skipped without an alert: one is made and decided in the same step") {
  auto bench = paper();
  CHECK(bench->decide(of_run({"t7"}, Verdict::override_, "pioneer2")) == "accepted");
  CHECK(rulings(bench->taken.at(0)) == "t7>pioneer2");
  const Alert alert = bench->any(bench->taken[0].alert);
  CHECK(alert.cause == "asked");
  CHECK(alert.state == AlertState::decided);
  CHECK(alert.text == "asked by 'ann': it is nearer");
  CHECK(bench->taken[0].person == "ann");
  CHECK(bench->decide(of_run({"t6"}, Verdict::accept)) == "accepted");
  CHECK(rulings(bench->taken.at(1)) == "t6>ridgeback");  // it stands nearest
  CHECK(bench->decide(of_run({"t9", "t9"}, Verdict::skip)) == "accepted");
  CHECK(rulings(bench->taken.at(2)) == "t9/cloud");
  CHECK(bench->alerts().empty());
  CHECK(bench->alerts(true).size() == 3);  // that a task is given back for it is no failure
}

TEST_CASE("a word on a task that makes no sense is refused, with the cure, and leaves nothing behind") {
  auto bench = paper();
  const auto refused = [&](AlertDecide word) {
    const std::string code = bench->decide(std::move(word));
    CHECK(bench->last_text.find(" | ") + 3 < bench->last_text.size());
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
  CHECK(bench->alerts(true).empty());
  CHECK(bench->taken.empty());
}

TEST_CASE("tasks of which an open alert tells are decided on there") {
  auto bench = paper();
  wheels_fail(*bench);
  const std::string id = bench->run_alert().id;
  CHECK(bench->decide(of_run({"t4", "t9"}, Verdict::skip)) == "conflict");
  CHECK(bench->decide(of_run({"t4"}, Verdict::skip)) == "accepted");
  CHECK(bench->taken.at(0).alert == id);
  CHECK(bench->run_alert().tasks == Words{"t7"});
}

TEST_CASE("what was done twice is told until the run goes on: nothing is moved, tried again or skipped") {
  auto bench = paper();
  bench->task("t3").twice = true;
  bench->changed();
  bench->wait(seconds(2));
  CHECK(bench->alerts().empty());  // somebody has let the run go on
  bench->view.paused_by = "cloud";
  bench->view.state = RunState::paused;
  bench->changed();
  bench->wait(seconds(2));
  const Alert alert = bench->alert();
  CHECK(alert.cause == "double_execution");
  CHECK(alert.severity == Severity::critical);
  CHECK(alert.robot == "ur3");
  CHECK(alert.tasks == Words{"t3"});
  CHECK(alert.proposals.empty());
  CHECK(alert.text.find("trb scenario resume 01234567") != std::string::npos);
  for (const Verdict verdict : {Verdict::accept, Verdict::override_, Verdict::retry, Verdict::skip}) {
    CHECK(bench->decide(verdict, "ur3", true, "x") == "conflict");
    CHECK(bench->last_text.find("trb scenario resume 01234567") != std::string::npos);
  }
  bench->wait(seconds(700));
  CHECK(bench->alert().state == AlertState::open);
  SUBCASE("looked at, and on it goes") {
    bench->view.paused_by.clear();
    bench->changed();
    bench->wait(seconds(2));
    CHECK(bench->any(alert.id).state == AlertState::closed);
    CHECK(bench->alerts().empty());
  }
  SUBCASE("the end") {
    CHECK(bench->decide(Verdict::abort) == "accepted");
    CHECK(bench->view.state == RunState::aborted);
    CHECK(bench->alerts().empty());
  }
}

TEST_CASE("a robot that gives nothing back for 30 s: it is said, and another verdict is taken") {
  for (const bool stands : {true, false}) {
    auto bench = paper();
    wheels_fail(*bench);
    bench->keeps.insert("ridgeback");
    CHECK(bench->decide(Verdict::accept) == "accepted");
    bench->wait(seconds(28));
    CHECK(bench->decide(Verdict::accept, "pioneer2") == "conflict");
    bench->wait(seconds(3));
    CHECK(
        bench->run_alert().waits_for.starts_with("ridgeback to give task 't7' back; it has been waited for for 30 s"));
    const std::size_t asked = bench->releases.size();
    if (stands) {
      CHECK(bench->decide(Verdict::accept, "pioneer2", true) == "accepted");
      bench->wait(seconds(6));
      REQUIRE(bench->taken.size() == 1);
      CHECK(rulings(bench->taken.at(0)) == "t4>pioneer2 t7>pioneer2?");
      continue;
    }
    CHECK(bench->decide(Verdict::override_, "ridgeback", false, "again") == "bad_value");
    CHECK(bench->run_alert().proposals.front().robot == "pioneer1");  // what was decided before still is
    CHECK(bench->run_alert().state == AlertState::releasing);
    CHECK(bench->decide(Verdict::accept, "pioneer2") == "accepted");
    CHECK(bench->releases.size() == asked + 1);  // asked at once, not when it was to be asked next
    bench->keeps.clear();
    bench->wait(seconds(2));
    CHECK(rulings(bench->taken.at(0)) == "t4>pioneer2 t7>pioneer2");
  }
}

TEST_CASE("decided anew it is on proposals of now, not on an override that did not come about") {
  auto bench = paper();
  bench->task("t4").failed_by = {"pioneer1"};
  bench->changed();
  bench->settle();
  wheels_fail(*bench);
  bench->keeps.insert("ridgeback");
  CHECK(bench->decide(Verdict::override_, "pioneer1", false, "it was cleaned") == "accepted");
  bench->wait(seconds(31));
  CHECK(bench->decide(Verdict::accept, "pioneer1") == "bad_value");
  CHECK(bench->run_alert().verdict == Verdict::override_);
}

TEST_CASE("a task that its robot has given back is somebody else's, though nothing else is the matter") {
  auto bench = paper();
  bench->task("t7").outcome = TaskOutcome::released;
  bench->task("t7").attempt = 1;
  bench->changed();
  bench->settle();
  CHECK(bench->view.state == RunState::running);
  CHECK(bench->alert().tasks == Words{"t7"});
  CHECK(bench->alert().cause == "task_failed");
  CHECK(bench->decide(Verdict::accept) == "accepted");
  CHECK(rulings(bench->taken.at(0)) == "t7>pioneer1");
}
