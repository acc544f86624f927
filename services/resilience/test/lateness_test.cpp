// Nothing has failed, and yet a task makes no progress: people are notified. Also runs that end soon, and tasks that
// the scenario may skip.
#include <doctest/doctest.h>

#include "services/resilience/test/fixture.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

Task& task_of(Fixture& fixture, const std::string& id) {
  return fixture.start.scenario.tasks[static_cast<std::size_t>(&fixture.task(id) - fixture.view.tasks.data())];
}

/// As the paper's, but t4 has this time-out.
std::unique_ptr<Fixture> timed(double timeout_s, ResilienceSettings settings = default_resilience()) {
  auto fixture = paper(settings);
  task_of(*fixture, "t4").timeout_s = timeout_s;
  fixture->restart();
  fixture->wait(seconds(6));
  return fixture;
}

void make_due(Fixture& fixture, const std::string& id) {
  fixture.task(id).due = true;
  fixture.changed();
  fixture.settle();
}

/// Its robot has nothing to do.
void make_idle(Fixture& fixture) {
  fixture.task("t4").state = TaskState::waiting;
  fixture.changed();
}

/// A run with this much of its life left.
std::unique_ptr<Fixture> ending(double life_s, double left_s) {
  auto fixture = paper();
  fixture->start.created = 1;
  fixture->start.expires = 1 + static_cast<std::int64_t>(life_s * 1e9);
  fixture->ends_at = fixture->now().mono + seconds(left_s);
  fixture->restart();
  fixture->wait(seconds(6));
  return fixture;
}

}  // namespace

TEST_CASE("a task that runs past its time-out is an alert, which a person decides on and no policy") {
  auto fixture = timed(40, automatic());
  fixture->wait(seconds(53));
  CHECK(fixture->alerts().empty());
  fixture->wait(seconds(2));
  const Alert alert = fixture->alert();
  CHECK(alert.cause == "task_overdue");
  CHECK(alert.severity == Severity::urgent);
  CHECK(alert.robot == "ridgeback");
  CHECK(alert.tasks == std::vector<std::string>{"t4"});
  CHECK(alert.text == "task 't4' runs at ridgeback for more than 60 s, past its time-out");
  CHECK(alert.proposals.front().robot == "pioneer1");
  fixture->wait(seconds(30));
  CHECK(fixture->taken.empty());
  CHECK(fixture->alert().policy.starts_with("automatic, but asks: nothing has failed"));
  CHECK(fixture->decide(Verdict::retry) == "conflict");
  CHECK(fixture->decide(Verdict::accept, "", true) == "accepted");
  fixture->wait(seconds(4));
  CHECK(fixture->taken.empty());  // it can be reached: it is asked first
  CHECK_FALSE(fixture->releases.empty());
  fixture->wait(seconds(2));
  REQUIRE(fixture->taken.size() == 1);
  CHECK(rulings(fixture->taken.at(0)) == "t4>pioneer1?");
}

TEST_CASE(
    "a robot of which a person says that it stands, and which can be reached, is told to stop; then its task moves") {
  auto fixture = timed(40);
  fixture->wait(seconds(56));
  CHECK(fixture->decide(Verdict::accept, "", true) == "accepted");
  REQUIRE_FALSE(fixture->releases.empty());
  CHECK(fixture->releases.back().stop);
  fixture->wait(seconds(1));
  fixture->end_task("t4", TaskOutcome::retriable);
  REQUIRE(fixture->taken.size() == 1);
  CHECK(rulings(fixture->taken.at(0)) == "t4>pioneer1");
}

TEST_CASE("a run whose end comes near because a clock was put right is told of, though nothing else happens in it") {
  auto fixture = ending(24 * 3600, 10 * 3600);
  CHECK(fixture->run_alerts().empty());
  fixture->ends_at = fixture->now().mono + seconds(360);
  fixture->wait(seconds(15));
  CHECK(fixture->alert().cause == kRunEnds);
  fixture->ends_at = fixture->now().mono + seconds(10 * 3600);
  fixture->wait(seconds(15));
  CHECK(fixture->run_alerts().empty());
}

TEST_CASE("a result that is on its way is not overtaken by a person's word that its robot stands") {
  auto fixture = timed(40);
  fixture->wait(seconds(56));
  const std::string id = fixture->alert().id;
  CHECK(fixture->decide(Verdict::accept, "", true) == "accepted");
  fixture->wait(seconds(2));
  fixture->end_task("t4", TaskOutcome::finished);
  fixture->wait(seconds(10));
  CHECK(fixture->taken.empty());
  CHECK(fixture->any(id).state == AlertState::closed);
}

TEST_CASE("why a verdict on what is overdue was in vain stays to be read") {
  auto fixture = timed(40);
  fixture->wait(seconds(56));
  const std::string overdue = fixture->alert().text;
  fixture->refuses = "conflict";
  CHECK(fixture->decide(Verdict::accept, "", true) == "accepted");
  fixture->wait(seconds(10));
  const Alert alert = fixture->alert();
  CHECK(alert.state == AlertState::open);
  CHECK(alert.text.starts_with(overdue + "; tried in vain: "));
}

TEST_CASE("the alert of what is overdue closes when the task goes on, and stays the same over a restart") {
  auto fixture = timed(40);
  fixture->wait(seconds(56));
  const std::string id = fixture->alert().id;
  fixture->restart();
  fixture->wait(seconds(8));
  CHECK(fixture->alert().id == id);
  fixture->end_task("t4", TaskOutcome::finished);
  CHECK(fixture->any(id).state == AlertState::closed);
  CHECK(fixture->alerts().empty());
}

TEST_CASE("a fault that explains what is overdue is the alert, and the other one is closed") {
  auto fixture = timed(40);
  fixture->wait(seconds(56));
  const std::string id = fixture->alert().id;
  fixture->fault("ridgeback", "mobile");
  CHECK(fixture->alert().cause == "robot_fault");
  CHECK(fixture->any(id).state == AlertState::closed);
}

TEST_CASE("a task that is due and not begun is an alert after 30 s, with what it waits for; a held run's is none") {
  auto fixture = paper();
  make_idle(*fixture);
  fixture->task("t7").waits_for = "run 17";
  make_due(*fixture, "t7");
  fixture->wait(seconds(29));
  CHECK(fixture->alerts().empty());
  fixture->wait(seconds(2));
  CHECK(fixture->alert().text == "task 't7' is due for 30 s and ridgeback has not begun it: it waits for run 17");
  fixture->view.paused_by = "ann";
  fixture->changed();
  fixture->wait(seconds(60));
  CHECK(fixture->alerts().empty());
  fixture->view.paused_by.clear();
  fixture->task("t7").state = TaskState::running;
  fixture->changed();
  fixture->wait(seconds(60));
  CHECK(fixture->alerts().empty());
}

TEST_CASE(
    "a task that has begun meanwhile, of which nothing was heard, is not late: the view is requested anew before") {
  auto fixture = paper();
  make_due(*fixture, "t7");
  fixture->task("t7").state = TaskState::running;
  fixture->wait(seconds(60));
  CHECK(fixture->alerts(true).empty());
}

TEST_CASE("a task whose robot does another one waits without an alert, and is late only 30 s after that one's end") {
  auto fixture = paper();
  make_due(*fixture, "t7");
  fixture->wait(seconds(90));
  CHECK(fixture->alerts(true).empty());
  make_idle(*fixture);
  fixture->wait(seconds(29));
  CHECK(fixture->alerts().empty());
  fixture->wait(seconds(2));
  CHECK(fixture->alert().tasks == std::vector<std::string>{"t7"});
}

TEST_CASE("nothing is late by what the scheduler showed before it fell silent") {
  auto fixture = paper();
  make_idle(*fixture);
  make_due(*fixture, "t7");
  fixture->deaf = true;
  fixture->wait(seconds(60));
  CHECK(fixture->alerts().empty());
  fixture->deaf = false;
  fixture->wait(seconds(6));
  CHECK(fixture->alert().cause == "task_overdue");
}

TEST_CASE("on a robot's node it is told, too, and where it is decided") {
  auto fixture = timed(40);
  fixture->settings.role = Role::robot;
  fixture->restart();
  fixture->wait(seconds(66));
  CHECK(fixture->alert().cause == "task_overdue");
  CHECK(fixture->alert().waits_for == "a verdict on node cloud");
  CHECK(fixture->decide(Verdict::skip) == "not_permitted");
}

TEST_CASE("its robot is gone and it did not begin in time: the decider skips it, as the scenario's author has said") {
  for (const OnFailure way : {OnFailure::skip, OnFailure::continue_}) {
    auto fixture = paper();
    task_of(*fixture, "t7").start_within_s = 20;
    task_of(*fixture, "t7").on_failure = way;
    fixture->restart();
    fixture->wait(seconds(6));
    fixture->silence("ridgeback");
    make_due(*fixture, "t7");
    fixture->wait(seconds(24));
    CHECK(fixture->taken.empty());
    fixture->wait(seconds(3));
    REQUIRE(fixture->taken.size() == 1);
    CHECK(rulings(fixture->taken[0]) == "t7/cloud?");
    CHECK(fixture->taken[0].person.empty());
    CHECK(fixture->taken[0].reason == "did not begin within 20 s");
    CHECK(fixture->alert().cause == "peer_expired");
    CHECK(fixture->alert().tasks == std::vector<std::string>{"t4", "t9"});
    fixture->wait(seconds(60));
    CHECK(fixture->taken.size() == 1);
  }
}

TEST_CASE("a task that its robot began before it was gone is not skipped, though nothing was heard of its beginning") {
  auto fixture = paper();
  task_of(*fixture, "t7").start_within_s = 20;
  task_of(*fixture, "t7").on_failure = OnFailure::continue_;
  fixture->restart();
  fixture->wait(seconds(6));
  make_due(*fixture, "t7");
  SUBCASE("long before") {
    fixture->task("t7").state = TaskState::running;
    fixture->wait(seconds(10));
    fixture->silence("ridgeback");
  }
  SUBCASE("when it was late already") {
    fixture->wait(seconds(26));
    fixture->task("t7").state = TaskState::running;
    fixture->silence("ridgeback");
  }
  fixture->wait(seconds(60));
  CHECK(fixture->heard["run_decision"] == 0);
  CHECK(fixture->run_alert().cause == "peer_expired");
}

TEST_CASE("a cloud node that does not decide the run skips nothing in it") {
  auto fixture = paper();
  task_of(*fixture, "t7").start_within_s = 20;
  task_of(*fixture, "t7").on_failure = OnFailure::skip;
  fixture->decided_elsewhere();
  fixture->restart();
  fixture->wait(seconds(6));
  fixture->silence("ridgeback");
  make_due(*fixture, "t7");
  fixture->wait(seconds(90));
  CHECK(fixture->heard["run_decision"] == 0);
  CHECK(fixture->alert().waits_for == "a verdict on node cloud2");
}

TEST_CASE("a robot that is there says itself that it did not begin; where people are to decide they are told") {
  auto fixture = paper();
  task_of(*fixture, "t7").start_within_s = 20;
  task_of(*fixture, "t7").on_failure = OnFailure::skip;
  fixture->restart();
  fixture->wait(seconds(6));
  make_idle(*fixture);
  make_due(*fixture, "t7");
  fixture->wait(seconds(60));
  CHECK(fixture->taken.empty());
  CHECK(fixture->alert().cause == "task_overdue");

  fixture = paper();
  task_of(*fixture, "t7").start_within_s = 20;
  fixture->restart();
  fixture->wait(seconds(6));
  make_due(*fixture, "t7");
  fixture->silence("ridgeback");
  fixture->wait(seconds(60));
  CHECK(fixture->taken.empty());
  CHECK(fixture->alert().cause == "peer_expired");
}

TEST_CASE("a scheduler that refuses the skip is not asked again and again") {
  auto fixture = paper();
  task_of(*fixture, "t7").start_within_s = 20;
  task_of(*fixture, "t7").on_failure = OnFailure::skip;
  fixture->restart();
  fixture->wait(seconds(6));
  fixture->refuses = "bad_value";
  fixture->silence("ridgeback");
  make_due(*fixture, "t7");
  fixture->wait(seconds(120));
  CHECK(fixture->heard["run_decision"] == 1);
  CHECK(fixture->alert().cause == "peer_expired");
}

TEST_CASE("a run that ends soon is told of: a tenth of its life before, 10 min at most") {
  struct Row {
    double life_s;
    double before_s;
  };
  for (const Row& row : {Row{86400, 600}, Row{3600, 360}, Row{660, 66}, Row{300, 30}}) {
    CAPTURE(row.life_s);
    auto fixture = ending(row.life_s, row.before_s + 20);
    CHECK(fixture->alerts().empty());
    fixture->wait(seconds(13));
    CHECK(fixture->alerts().empty());
    fixture->wait(seconds(2));
    const Alert alert = fixture->alert();
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
  auto fixture = ending(86400, 500);
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  CHECK(fixture->alerts().size() == 2);
  for (const Alert& one : fixture->alerts()) {
    if (one.cause != "run_ends") continue;
    CHECK(one.text.find("ends in 8 min") != std::string::npos);
    for (const Verdict verdict : {Verdict::accept, Verdict::retry, Verdict::skip}) {
      CHECK(fixture->decide(AlertDecide{one.id, verdict, "", "", "", false}) == "conflict");
    }
  }
  fixture->wait(seconds(500));
  fixture->view.state = RunState::expired;
  if (told) fixture->changed();
  fixture->wait(seconds(12));
  CHECK(fixture->alerts().empty());
  for (const Alert& one : fixture->alerts(true)) {
    CHECK(one.waits_for == "its run has EXPIRED: trb run show 01234567 has everything");
  }
}
