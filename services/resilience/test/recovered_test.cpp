// The scheduler may have lost the run, and asks its members: what it shows meanwhile may be old, and it takes no
// decision.
#include <doctest/doctest.h>

#include "services/resilience/test/wheels_fail.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

void recover(Fixture& fixture, bool begins) {
  fixture.view.recovers = begins;
  fixture.changed();
  fixture.settle();
}

}  // namespace

TEST_CASE("of a run that is being recovered nothing is raised or decided, and all of it once that is over") {
  auto fixture = paper(automatic());
  recover(*fixture, true);
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  fixture->wait(seconds(20));
  CHECK(fixture->alerts().empty());
  CHECK(fixture->taken.empty());
  recover(*fixture, false);
  CHECK(fixture->alerts().size() == 1);
  fixture->wait(seconds(10));
  REQUIRE(fixture->taken.size() == 1);
  CHECK(rulings(fixture->taken[0]).find("t4>pioneer1") != std::string::npos);
}

TEST_CASE("an old view closes no alert, and a verdict is refused until what was decided is known; an abort is not") {
  auto fixture = paper();
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  fixture->wait(seconds(6));
  const std::string id = fixture->run_alert().id;
  recover(*fixture, true);
  fixture->task("t4").outcome = TaskOutcome::none;
  fixture->task("t4").state = TaskState::running;
  fixture->changed();
  fixture->wait(seconds(5));
  REQUIRE(fixture->run_alert().id == id);
  CHECK(fixture->run_alert().waits_for.starts_with("its run, of which"));
  CHECK(fixture->decide(Verdict::accept, "pioneer1") == "timeout");
  CHECK(fixture->last_text.find("not known on this node yet") != std::string::npos);
  SUBCASE("it is over") {
    fixture->end_task("t4", TaskOutcome::failed, "stuck");
    recover(*fixture, false);
    CHECK(fixture->decide(Verdict::accept, "pioneer1") == "accepted");
    fixture->wait(seconds(5));
    CHECK(fixture->taken.size() == 1);
  }
  SUBCASE("a person ends the run") {
    CHECK(fixture->decide(Verdict::abort) == "accepted");
    fixture->wait(seconds(5));
    CHECK(fixture->view.state == RunState::aborted);
  }
}

TEST_CASE("what was decided before is not carried out while the run is being recovered: no robot gives tasks back") {
  auto fixture = paper();
  fixture->keeps.insert("ridgeback");
  wheels_fail(*fixture);
  fixture->wait(seconds(6));
  CHECK(fixture->decide(Verdict::accept, "pioneer1") == "accepted");
  fixture->wait(seconds(3));
  const std::size_t asked = fixture->releases.size();
  REQUIRE(asked > 0);
  recover(*fixture, true);
  fixture->wait(seconds(60));
  CHECK(fixture->releases.size() == asked);
  fixture->keeps.clear();
  recover(*fixture, false);
  fixture->wait(seconds(10));
  CHECK(fixture->releases.size() > asked);
  CHECK(fixture->taken.size() == 1);
}

TEST_CASE("however long it takes the policy decides afterwards, by what the robots tell then") {
  auto fixture = paper(automatic());
  fixture->wait(seconds(60));
  for (const char* one : {"pioneer1", "pioneer2", "turtlebot"}) fixture->mute.insert(one);
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  fixture->settle();
  REQUIRE(fixture->taken.empty());
  recover(*fixture, true);
  fixture->mute.clear();
  fixture->wait(seconds(1800));
  CHECK(fixture->taken.empty());
  CHECK(fixture->run_alert().state == AlertState::open);
  recover(*fixture, false);
  fixture->wait(seconds(10));
  CHECK(fixture->taken.size() == 1);
}

TEST_CASE("a decision that was on its way when it began is handed on anew, and the policy goes on") {
  auto fixture = paper(automatic());
  fixture->refuses = "timeout";
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  fixture->wait(seconds(6));
  recover(*fixture, true);
  const int handed = fixture->heard["run_decision"];
  CHECK(handed > 0);
  fixture->wait(seconds(60));
  CHECK(fixture->heard["run_decision"] == handed);
  fixture->refuses.clear();
  recover(*fixture, false);
  fixture->wait(seconds(10));
  CHECK(fixture->taken.size() == 1);
}

TEST_CASE("what was due before is not late because it was not shown as due meanwhile") {
  auto fixture = paper();
  fixture->task("t6").due = true;
  fixture->changed();
  fixture->wait(seconds(20));
  fixture->task("t6").due = false;
  recover(*fixture, true);
  fixture->wait(seconds(60));
  fixture->task("t6").due = true;
  recover(*fixture, false);
  fixture->wait(seconds(20));
  CHECK(fixture->run_alerts().empty());
  fixture->wait(seconds(20));
  CHECK(fixture->run_alert().cause == "task_overdue");
}
