// A retired robot keeps its running tasks and gives the others away, until it returns.
#include <doctest/doctest.h>

#include "services/resilience/test/history.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

TEST_CASE("a retired robot ends what runs and gives the rest away; it is no candidate, and no alert of its own") {
  auto fixture = paper();
  fixture->retire("ridgeback", "new wheels", "ann");
  fixture->wait(seconds(40));
  const Alert alert = fixture->alert();
  CHECK(alert.cause == "robot_retired");
  CHECK(alert.severity == Severity::warning);
  CHECK(alert.text == "ridgeback is out of service: new wheels (by ann)");
  CHECK(alert.tasks == std::vector<std::string>{"t7", "t9"});  // t4 runs
  CHECK(fixture->decide(Verdict::retry) == "conflict");
  CHECK(fixture->decide(AlertDecide{alert.id, Verdict::accept, "", "", "", false, "", {"t7"}}) == "accepted");
  CHECK(rulings(fixture->taken.at(0)) == "t7>pioneer1");
  CHECK(fixture->releases.at(0).tasks == std::vector<std::uint16_t>{6});
  fixture->retire("pioneer2", "", "bob");
  fixture->wait(seconds(40));
  CHECK(fixture->alert().tasks == std::vector<std::string>{"t9"});
  fixture->fault("pioneer1", "mobile");
  for (const Alert& one : fixture->alerts()) {
    if (one.robot != "pioneer1") continue;
    REQUIRE(one.unfit.size() == 2);
    CHECK(one.unfit[0].why == "is out of service (by bob)");
    CHECK(one.unfit[1].why == "is out of service: new wheels (by ann)");
    CHECK(fixture->decide(AlertDecide{one.id, Verdict::override_, "pioneer2", "", "go", false}) == "conflict");
  }
  fixture->return_to_service("ridgeback");
  fixture->return_to_service("pioneer2");
  fixture->wait(seconds(6));
  CHECK(fixture->alert().robot == "pioneer1");
  const auto history = kinds(*fixture, "ridgeback");
  CHECK(count_of(history, "retired") == 1);
  CHECK(count_of(history, "returned") == 1);
}

TEST_CASE("that a robot is out of service, or has returned, is known within 5 s") {
  auto fixture = paper();
  for (TaskView& task : fixture->view.tasks) task.state = TaskState::finished;
  fixture->view.state = RunState::finished;
  fixture->changed();
  fixture->retire("pioneer1", "new wheels", "ann");
  fixture->wait(seconds(31));  // nothing goes on
  CHECK(count_of(kinds(*fixture, "pioneer1"), "retired") == 1);
  fixture->return_to_service("pioneer1");
  fixture->wait(seconds(5));
  CHECK(count_of(kinds(*fixture, "pioneer1"), "returned") == 1);
}

TEST_CASE("killed and started again, a retired robot is none that could take over before its node says so anew") {
  auto fixture = paper();
  fixture->retire("pioneer1", "new wheels", "ann");
  fixture->wait(seconds(40));
  fixture->restart();
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  fixture->wait(seconds(6));
  CHECK(fixture->alert().proposals.front().robot == "pioneer2");
}
