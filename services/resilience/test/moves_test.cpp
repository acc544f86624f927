// A task that fails on every robot: none is tried twice, and after a few moves a person is asked.
#include <doctest/doctest.h>

#include <algorithm>

#include "services/resilience/test/fixture.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

bool is_proposed(const Alert& alert, const std::string& robot) {
  return std::ranges::any_of(alert.proposals, [&](const Proposal& one) { return one.robot == robot; });
}

void add_decision(Fixture& fixture, std::uint32_t epoch) {
  Decision decision;
  decision.epoch = epoch;
  decision.run = kRun;
  SignedRecord record;
  record.payload.bytes = encode(decision);
  fixture.decisions.push_back(record);
}

/// Gives the run this many decisions of people.
void fill_decisions(Fixture& fixture, std::uint32_t count) {
  for (std::uint32_t epoch = 2; epoch < count + 2; ++epoch) {
    add_decision(fixture, epoch);
    fixture.view.decisions.push_back({epoch, "cloud", "another", "bob", "", 0, {}});
  }
  fixture.view.epoch = count + 1;
  fixture.changed();
  fixture.settle();
}

}  // namespace

TEST_CASE("a task that fails everywhere goes to nobody twice; the policy moves it two times, then a person is asked") {
  auto fixture = paper(automatic());
  for (int i = 0; i < 10; ++i) {
    if (fixture->task("t4").outcome == TaskOutcome::none) fixture->end_task("t4", TaskOutcome::failed, "stuck");
    fixture->wait(seconds(10));
  }
  REQUIRE(fixture->taken.size() == 2);
  CHECK(rulings(fixture->taken[0]) == "t4>pioneer1");
  CHECK(rulings(fixture->taken[1]) == "t4>pioneer2");
  const Alert alert = fixture->alert();
  CHECK(alert.policy == "automatic, but asks: it has moved task 't4' 2 times: a person decides");
  CHECK(alert.robot == "pioneer2");
  REQUIRE(alert.proposals.size() == 1);
  CHECK(alert.proposals[0].robot == "turtlebot");
  CHECK(why_unfit(alert, "ridgeback") == "has failed task 't4' already");
  CHECK(why_unfit(alert, "pioneer1") == "has failed task 't4' already");
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  CHECK(rulings(fixture->taken.at(2)) == "t4>turtlebot");
}

TEST_CASE("a person may send a task to who has failed it, with a reason") {
  auto fixture = paper();
  fixture->task("t4").failed_by = {"pioneer1"};
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  CHECK_FALSE(is_proposed(fixture->alert(), "pioneer1"));
  CHECK(fixture->decide(Verdict::accept, "pioneer1") == "bad_value");
  CHECK(fixture->decide(Verdict::override_, "pioneer1", false, "its gripper was cleaned") == "accepted");
  CHECK(rulings(fixture->taken.at(0)) == "t4>pioneer1");
}

TEST_CASE("who has failed one of two tasks may take the other: several do them between them") {
  auto fixture = paper();
  for (const char* id : {"pioneer2", "turtlebot"}) fixture->silence(id);
  fixture->task("t4").failed_by = {"pioneer1"};
  fixture->changed();
  fixture->settle();
  fixture->fault("ridgeback", "mobile");
  for (const Alert& alert : fixture->alerts()) {
    if (alert.robot != "ridgeback") continue;
    CHECK(alert.tasks == std::vector<std::string>{"t4", "t7"});
    CHECK(alert.proposals.empty());
    CHECK(why_unfit(alert, "pioneer1").starts_with("has failed task 't4' already"));
  }
  fixture->back("pioneer2");
  fixture->wait(seconds(6));
  for (const Alert& alert : fixture->alerts()) {
    if (alert.robot != "ridgeback") continue;
    REQUIRE(alert.proposals.size() == 1);
    CHECK(alert.proposals[0].robot == "pioneer2");
  }
}

TEST_CASE("moves that people have decided do not count, and the file says how many do") {
  ResilienceSettings settings = automatic();
  settings.policy.max_moves = 1;
  auto fixture = paper(settings);
  fixture->view.decisions.push_back({2, "cloud", "a", "bob", "", 0, {{"t4", Ruling::move, "ridgeback", 2, {}}}});
  add_decision(*fixture, 2);
  fixture->view.epoch = 2;
  fixture->task("t4").attempt = 2;
  fixture->changed();
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  fixture->wait(seconds(10));
  REQUIRE(fixture->taken.size() == 1);
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  fixture->wait(seconds(10));
  CHECK(fixture->taken.size() == 1);
  CHECK(fixture->alert().policy == "automatic, but asks: it has moved task 't4' 1 times: a person decides");
}

TEST_CASE("a run with its 64 decisions takes no more: the verdict is refused when it is given") {
  auto fixture = paper();
  fill_decisions(*fixture, 63);
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  CHECK(fixture->decide(Verdict::retry) == "accepted");
  REQUIRE(fixture->taken.size() == 1);
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  for (const Verdict verdict : {Verdict::accept, Verdict::retry, Verdict::skip}) {
    CHECK(fixture->decide(verdict) == "conflict");
    CHECK(fixture->last_text.find("64 decisions") != std::string::npos);
    CHECK(fixture->last_text.find("--abort") != std::string::npos);
  }
  CHECK(fixture->alert().state == AlertState::open);
  CHECK(fixture->heard["sign_request"] == 1);
  CHECK(fixture->decide(Verdict::abort) == "accepted");
}

TEST_CASE("a decision that is being made counts among the 64") {
  auto fixture = paper();
  fill_decisions(*fixture, 63);
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  fixture->end_task("t5", TaskOutcome::failed, "stuck");
  fixture->deaf = true;
  const auto alerts = fixture->alerts();
  REQUIRE(alerts.size() == 2);
  CHECK(fixture->decide(AlertDecide{alerts[0].id, Verdict::skip, "", "", "", false}) == "accepted");
  CHECK(fixture->decide(AlertDecide{alerts[1].id, Verdict::skip, "", "", "", false}) == "conflict");
}

TEST_CASE("64 attempts of a task are the most: after them it can only be left out") {
  auto fixture = paper();
  fixture->task("t4").attempt = 64;
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  for (const Verdict verdict : {Verdict::accept, Verdict::retry}) {
    CHECK(fixture->decide(verdict) == "conflict");
    CHECK(fixture->last_text.find("attempt 65") != std::string::npos);
    CHECK(fixture->last_text.find("--skip") != std::string::npos);
  }
  CHECK(fixture->decide(Verdict::skip) == "accepted");
  CHECK(fixture->taken.at(0).tasks.at(0).attempt == 65);
}

TEST_CASE("attempts that its robot may have made unheard are no more than 64: it can still be left out") {
  auto fixture = paper();
  fixture->start.scenario.tasks[3].retries = 5;
  add_decision(*fixture, 2);
  fixture->view.decisions.push_back({2, "cloud", "a", "bob", "", 0, {{"t4", Ruling::retry, "ridgeback", 62, {}}}});
  fixture->view.epoch = 2;
  fixture->task("t4").attempt = 64;
  fixture->restart();
  fixture->wait(seconds(6));
  fixture->silence("ridgeback");
  AlertDecide word{fixture->alert().id, Verdict::skip, "", "", "", true};
  word.tasks = {"t4"};
  CHECK(fixture->decide(word) == "accepted");
  CHECK(fixture->taken.at(0).tasks.at(0).attempt == 65);
}

TEST_CASE("a robot that is not there gets nothing, whatever the reason") {
  auto fixture = paper();
  fixture->silence("pioneer2");
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  CHECK(fixture->decide(Verdict::override_, "pioneer2", false, "it is mine") == "conflict");
  CHECK(fixture->last_text.find("is not there") != std::string::npos);
  CHECK(fixture->alert().verdict == Verdict::none);
}
