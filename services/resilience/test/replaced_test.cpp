// A computer in a node's place: the same name, new keys. A run that knows the old ones hears nothing more of it.
#include <doctest/doctest.h>

#include "services/resilience/core/run_problems.hpp"
#include "services/resilience/test/fixture.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

TEST_CASE("who is back with new keys is lost for the run: the alert says so, and a person's word moves the tasks") {
  auto fixture = paper(automatic());
  SUBCASE("its node was lost long before") {
    fixture->silence("ridgeback");
    fixture->wait(seconds(20));
    CHECK(fixture->alert().text == "its node is not reached");
    fixture->certify("ridgeback", 2, 'n');
    fixture->back("ridgeback");
  }
  SUBCASE("nobody has missed it") {
    fixture->certify("ridgeback", 2, 'n');
  }
  fixture->wait(seconds(8));
  const Alert alert = fixture->alert();
  CHECK(alert.cause == "peer_expired");
  CHECK(alert.severity == Severity::critical);
  CHECK(alert.text == kNewKeys);
  CHECK(alert.tasks == Words{"t4", "t7", "t9"});
  CHECK(alert.needs_word);
  CHECK(alert.policy == "automatic, but asks: only a person can say that ridgeback stands");
  CHECK(
      alert.waits_for.ends_with("; ridgeback has got new keys, and cannot tell what became of task 't4': --stands if "
                                "you have seen that ridgeback "
                                "stands"));
  AlertDecide verdict{alert.id, Verdict::accept, "", "", "", false, "", {"t4", "t7"}};
  CHECK(fixture->decide(verdict) == "bad_value");
  CHECK(fixture->last_text.find("--stands") != std::string::npos);
  CHECK(fixture->decide(Verdict::retry, "", true) == "conflict");
  verdict.stands = true;
  CHECK(fixture->decide(verdict) == "accepted");
  REQUIRE(fixture->taken.size() == 1);
  CHECK(rulings(fixture->taken[0]) == "t4>pioneer1? t7>pioneer1?");
  CHECK(fixture->releases.empty());
  fixture->wait(seconds(30));
  CHECK(fixture->alert().tasks == Words{"t9"});
}

TEST_CASE("what a node has ended with its old keys may move without a word; it tries nothing again") {
  auto fixture = paper();
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  fixture->certify("ridgeback", 2, 'n');
  fixture->wait(seconds(8));
  const Alert alert = fixture->alert();
  CHECK(alert.text == kNewKeys);
  CHECK(fixture->decide(AlertDecide{alert.id, Verdict::retry, "", "", "", false, "", {"t4"}}) == "conflict");
  CHECK(fixture->decide(AlertDecide{alert.id, Verdict::accept, "", "", "", false, "", {"t4"}}) == "accepted");
  CHECK(rulings(fixture->taken.at(0)) == "t4>pioneer1");
}

TEST_CASE("a verdict that waits for a robot which gets new keys meanwhile asks for the person's word at once") {
  auto fixture = paper();
  fixture->keeps = {"turtlebot"};
  AlertDecide verdict;
  verdict.run = kRun;
  verdict.tasks = {"t6"};
  verdict.verdict = Verdict::skip;
  REQUIRE(fixture->decide(verdict) == "accepted");
  const std::string id = fixture->alert().id;
  CHECK(fixture->alert().waits_for == "turtlebot to give task 't6' back");
  fixture->certify("turtlebot", 2, 'n');
  fixture->wait(seconds(8));
  CHECK(fixture->any(id).waits_for ==
        "turtlebot has got new keys, and cannot give task 't6' back: your word that it stands (--stands)");
  CHECK(fixture->decide(AlertDecide{id, Verdict::skip, "", "", "", true}) == "accepted");
  fixture->wait(seconds(1));
  CHECK(rulings(fixture->taken.at(0)) == "t6/cloud?");
}

TEST_CASE("a member with new keys takes nothing over in that run; who is none, or has its old keys, does") {
  auto fixture = paper();
  fixture->certify("turtlebot", 2, 'n');
  fixture->certify("pioneer2", 2, 'n');
  fixture->wait(seconds(8));
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  for (const Alert& alert : fixture->alerts()) {
    if (alert.robot != "ridgeback") continue;
    CHECK(robots_of(alert) == Words{"pioneer1", "pioneer2"});
    CHECK(why_unfit(alert, "turtlebot") == kNewKeys);
    CHECK(fixture->decide(AlertDecide{alert.id, Verdict::override_, "turtlebot", "", "go", false}) == "conflict");
  }
}

TEST_CASE("a certificate that was renewed, for the same keys, or an older one of other keys changes nothing") {
  auto fixture = paper();
  fixture->certify("ridgeback", 7, 0);
  fixture->certify("turtlebot", 0, 'o');
  fixture->wait(seconds(40));
  CHECK(fixture->alerts().empty());
}
