// Nobody has failed, and yet a task does not go on: people are told. Runs that end soon, and tasks whose scenario does
// without them.
#include <doctest/doctest.h>

#include "services/resilience/test/bench.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

Task& task_of(Bench& bench, const std::string& id) {
  return bench.start.scenario.tasks[static_cast<std::size_t>(&bench.task(id) - bench.view.tasks.data())];
}

/// As the paper's, but t4 may take so long.
std::unique_ptr<Bench> timed(double timeout_s, ResilienceSettings settings = default_resilience()) {
  auto bench = paper(settings);
  task_of(*bench, "t4").timeout_s = timeout_s;
  bench->restart();
  bench->wait(seconds(6));
  return bench;
}

void make_due(Bench& bench, const std::string& id) {
  bench.task(id).due = true;
  bench.changed();
  bench.settle();
}

/// So much of its life is left to the run.
std::unique_ptr<Bench> ending(double life_s, double left_s) {
  auto bench = paper();
  bench->start.created = 1;
  bench->start.expires = 1 + static_cast<std::int64_t>(life_s * 1e9);
  bench->ends_at = bench->now.mono + seconds(left_s);
  bench->restart();
  bench->wait(seconds(6));
  return bench;
}

}  // namespace

TEST_CASE("a task that runs past its time-out is an alert, which a person decides on and no policy") {
  auto bench = timed(40, automatic());
  bench->wait(seconds(53));
  CHECK(bench->alerts().empty());
  bench->wait(seconds(2));
  const Alert alert = bench->alert();
  CHECK(alert.cause == "task_overdue");
  CHECK(alert.severity == Severity::urgent);
  CHECK(alert.robot == "ridgeback");
  CHECK(alert.tasks == std::vector<std::string>{"t4"});
  CHECK(alert.text == "task 't4' runs at ridgeback for more than 60 s, past its time-out");
  CHECK(alert.proposals.front().robot == "pioneer1");
  bench->wait(seconds(30));
  CHECK(bench->taken.empty());
  CHECK(bench->alert().policy.starts_with("automatic, but asks: nothing has failed"));
  CHECK(bench->decide(Verdict::retry) == "conflict");
  CHECK(bench->decide(Verdict::accept, "", true) == "accepted");
  bench->wait(seconds(4));
  CHECK(bench->taken.empty());  // it can be reached: it is asked first
  CHECK_FALSE(bench->releases.empty());
  bench->wait(seconds(2));
  REQUIRE(bench->taken.size() == 1);
  CHECK(rulings(bench->taken.at(0)) == "t4>pioneer1?");
}

TEST_CASE(
    "a robot of which a person says that it stands, and which can be reached, is told to stop; then its task moves") {
  auto bench = timed(40);
  bench->wait(seconds(56));
  CHECK(bench->decide(Verdict::accept, "", true) == "accepted");
  REQUIRE_FALSE(bench->releases.empty());
  CHECK(bench->releases.back().stop);
  bench->wait(seconds(1));
  bench->end_task("t4", TaskOutcome::retriable);
  REQUIRE(bench->taken.size() == 1);
  CHECK(rulings(bench->taken.at(0)) == "t4>pioneer1");
}

TEST_CASE("a result that is on its way is not overtaken by a person's word that its robot stands") {
  auto bench = timed(40);
  bench->wait(seconds(56));
  const std::string id = bench->alert().id;
  CHECK(bench->decide(Verdict::accept, "", true) == "accepted");
  bench->wait(seconds(2));
  bench->end_task("t4", TaskOutcome::finished);
  bench->wait(seconds(10));
  CHECK(bench->taken.empty());
  CHECK(bench->any(id).state == AlertState::closed);
}

TEST_CASE("the alert of what is overdue closes when the task goes on, and stays the same over a restart") {
  auto bench = timed(40);
  bench->wait(seconds(56));
  const std::string id = bench->alert().id;
  bench->restart();
  bench->wait(seconds(8));
  CHECK(bench->alert().id == id);
  bench->end_task("t4", TaskOutcome::finished);
  CHECK(bench->any(id).state == AlertState::closed);
  CHECK(bench->alerts().empty());
}

TEST_CASE("a fault that explains what is overdue is the alert, and the other one is closed") {
  auto bench = timed(40);
  bench->wait(seconds(56));
  const std::string id = bench->alert().id;
  bench->fault("ridgeback", "mobile");
  CHECK(bench->alert().cause == "robot_fault");
  CHECK(bench->any(id).state == AlertState::closed);
}

TEST_CASE("a task that is due and not begun is an alert after 30 s, with what it waits for; a held run's is none") {
  auto bench = paper();
  bench->task("t7").waits_for = "run 17";
  make_due(*bench, "t7");
  bench->wait(seconds(29));
  CHECK(bench->alerts().empty());
  bench->wait(seconds(2));
  CHECK(bench->alert().text == "task 't7' is due for 30 s and ridgeback has not begun it: it waits for run 17");
  bench->view.paused_by = "ann";
  bench->changed();
  bench->wait(seconds(60));
  CHECK(bench->alerts().empty());
  bench->view.paused_by.clear();
  bench->task("t7").state = TaskState::running;
  bench->changed();
  bench->wait(seconds(60));
  CHECK(bench->alerts().empty());
}

TEST_CASE("on a robot's node it is told, too, and where it is decided") {
  auto bench = timed(40);
  bench->settings.role = Role::robot;
  bench->restart();
  bench->wait(seconds(66));
  CHECK(bench->alert().cause == "task_overdue");
  CHECK(bench->alert().waits_for == "a verdict on node cloud");
  CHECK(bench->decide(Verdict::skip) == "not_permitted");
}

TEST_CASE("its robot is gone and it did not begin in time: the decider skips it, as the scenario's author has said") {
  for (const OnFailure way : {OnFailure::skip, OnFailure::continue_}) {
    auto bench = paper();
    task_of(*bench, "t7").start_within_s = 20;
    task_of(*bench, "t7").on_failure = way;
    bench->restart();
    bench->wait(seconds(6));
    bench->silence("ridgeback");
    make_due(*bench, "t7");
    bench->wait(seconds(24));
    CHECK(bench->taken.empty());
    bench->wait(seconds(3));
    REQUIRE(bench->taken.size() == 1);
    CHECK(rulings(bench->taken[0]) == "t7/cloud?");
    CHECK(bench->taken[0].person.empty());
    CHECK(bench->taken[0].reason == "did not begin within 20 s");
    CHECK(bench->alert().cause == "peer_expired");
    CHECK(bench->alert().tasks == std::vector<std::string>{"t4", "t9"});
    bench->wait(seconds(60));
    CHECK(bench->taken.size() == 1);
  }
}

TEST_CASE("a cloud node that does not decide the run skips nothing in it") {
  auto bench = paper();
  task_of(*bench, "t7").start_within_s = 20;
  task_of(*bench, "t7").on_failure = OnFailure::skip;
  bench->decided_elsewhere();
  bench->restart();
  bench->wait(seconds(6));
  bench->silence("ridgeback");
  make_due(*bench, "t7");
  bench->wait(seconds(90));
  CHECK(bench->heard["run_decision"] == 0);
  CHECK(bench->alert().waits_for == "a verdict on node cloud2");
}

TEST_CASE("a robot that is there says itself that it did not begin; where people are to decide they are told") {
  auto bench = paper();
  task_of(*bench, "t7").start_within_s = 20;
  task_of(*bench, "t7").on_failure = OnFailure::skip;
  bench->restart();
  bench->wait(seconds(6));
  make_due(*bench, "t7");
  bench->wait(seconds(60));
  CHECK(bench->taken.empty());
  CHECK(bench->alert().cause == "task_overdue");

  bench = paper();
  task_of(*bench, "t7").start_within_s = 20;
  bench->restart();
  bench->wait(seconds(6));
  make_due(*bench, "t7");
  bench->silence("ridgeback");
  bench->wait(seconds(60));
  CHECK(bench->taken.empty());
  CHECK(bench->alert().cause == "peer_expired");
}

TEST_CASE("a scheduler that refuses the skip is not asked again and again") {
  auto bench = paper();
  task_of(*bench, "t7").start_within_s = 20;
  task_of(*bench, "t7").on_failure = OnFailure::skip;
  bench->restart();
  bench->wait(seconds(6));
  bench->refuses = "bad_value";
  bench->silence("ridgeback");
  make_due(*bench, "t7");
  bench->wait(seconds(120));
  CHECK(bench->heard["run_decision"] == 1);
  CHECK(bench->alert().cause == "peer_expired");
}

TEST_CASE("a run that ends soon is told of: a tenth of its life before, 10 min at most") {
  struct Row {
    double life_s;
    double before_s;
  };
  for (const Row& row : {Row{86400, 600}, Row{3600, 360}, Row{660, 66}, Row{300, 30}}) {
    CAPTURE(row.life_s);
    auto bench = ending(row.life_s, row.before_s + 20);
    CHECK(bench->alerts().empty());
    bench->wait(seconds(13));
    CHECK(bench->alerts().empty());
    bench->wait(seconds(2));
    const Alert alert = bench->alert();
    CHECK(alert.cause == "run_ends");
    CHECK(alert.severity == Severity::warning);
    CHECK(alert.proposals.empty());
    CHECK(alert.text.starts_with("run demonstration ends in "));
    CHECK(alert.waits_for.starts_with("its end in "));
  }
}

TEST_CASE("a run that has ended of itself closes its alerts, and they say where everything is") {
  bool told = false;
  SUBCASE("the scheduler says so") {
    told = true;
  }
  SUBCASE("nobody has heard it say so") {
    told = false;
  }
  auto bench = ending(86400, 500);
  bench->end_task("t4", TaskOutcome::failed, "stuck");
  CHECK(bench->alerts().size() == 2);
  for (const Alert& one : bench->alerts()) {
    if (one.cause != "run_ends") continue;
    CHECK(one.text.find("ends in 8 min") != std::string::npos);
    for (const Verdict verdict : {Verdict::accept, Verdict::retry, Verdict::skip}) {
      CHECK(bench->decide(AlertDecide{one.id, verdict, "", "", "", false}) == "conflict");
    }
  }
  bench->wait(seconds(500));
  bench->view.state = RunState::expired;
  if (told) bench->changed();
  bench->wait(seconds(12));
  CHECK(bench->alerts().empty());
  for (const Alert& one : bench->alerts(true)) {
    CHECK(one.waits_for == "its run has EXPIRED: trb run show 01234567 has everything");
  }
}
