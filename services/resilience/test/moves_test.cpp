// A task that fails wherever it goes: who has failed it is tried no more, and after a few moves a person is asked.
#include <doctest/doctest.h>

#include <algorithm>

#include "services/resilience/test/bench.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

std::string why_unfit(const Alert& alert, const std::string& robot) {
  for (const Unfit& one : alert.unfit) {
    if (one.robot == robot) return one.why;
  }
  return {};
}

bool is_proposed(const Alert& alert, const std::string& robot) {
  return std::ranges::any_of(alert.proposals, [&](const Proposal& one) { return one.robot == robot; });
}

/// The run has had so many decisions, by people.
void fill_decisions(Bench& bench, std::uint32_t count) {
  for (std::uint32_t epoch = 2; epoch < count + 2; ++epoch) {
    Decision decision;
    decision.epoch = epoch;
    decision.run = kRun;
    SignedRecord record;
    record.payload.bytes = encode(decision);
    bench.decisions.push_back(record);
    bench.view.decisions.push_back({epoch, "cloud", "another", "bob", "", 0, {}});
  }
  bench.view.epoch = count + 1;
  bench.changed();
  bench.settle();
}

}  // namespace

TEST_CASE("a task that fails everywhere goes to nobody twice; the policy moves it two times, then a person is asked") {
  auto bench = paper(automatic());
  for (int i = 0; i < 10; ++i) {
    if (bench->task("t4").outcome == TaskOutcome::none) bench->end_task("t4", TaskOutcome::failed, "stuck");
    bench->wait(seconds(10));
  }
  REQUIRE(bench->taken.size() == 2);
  CHECK(rulings(bench->taken[0]) == "t4>pioneer1");
  CHECK(rulings(bench->taken[1]) == "t4>pioneer2");
  const Alert alert = bench->alert();
  CHECK(alert.policy == "automatic, but asks: it has moved task 't4' 2 times: a person decides");
  CHECK(alert.robot == "pioneer2");
  REQUIRE(alert.proposals.size() == 1);
  CHECK(alert.proposals[0].robot == "turtlebot");
  CHECK(why_unfit(alert, "ridgeback") == "has failed task 't4' already");
  CHECK(why_unfit(alert, "pioneer1") == "has failed task 't4' already");
  CHECK(bench->decide(Verdict::accept) == "accepted");
  CHECK(rulings(bench->taken.at(2)) == "t4>turtlebot");
}

TEST_CASE("a person may send a task to who has failed it, with a reason") {
  auto bench = paper();
  bench->task("t4").failed_by = {"pioneer1"};
  bench->end_task("t4", TaskOutcome::failed, "stuck");
  CHECK_FALSE(is_proposed(bench->alert(), "pioneer1"));
  CHECK(bench->decide(Verdict::accept, "pioneer1") == "bad_value");
  CHECK(bench->decide(Verdict::override_, "pioneer1", false, "its gripper was cleaned") == "accepted");
  CHECK(rulings(bench->taken.at(0)) == "t4>pioneer1");
}

TEST_CASE("who has failed one of two tasks may take the other: several do them between them") {
  auto bench = paper();
  for (const char* id : {"pioneer2", "turtlebot"}) bench->silence(id);
  bench->task("t4").failed_by = {"pioneer1"};
  bench->changed();
  bench->settle();
  bench->fault("ridgeback", "mobile");
  for (const Alert& alert : bench->alerts()) {
    if (alert.robot != "ridgeback") continue;
    CHECK(alert.tasks == std::vector<std::string>{"t4", "t7"});
    CHECK(alert.proposals.empty());
    CHECK(why_unfit(alert, "pioneer1").starts_with("has failed task 't4' already"));
  }
  bench->back("pioneer2");
  bench->wait(seconds(6));
  for (const Alert& alert : bench->alerts()) {
    if (alert.robot != "ridgeback") continue;
    REQUIRE(alert.proposals.size() == 1);
    CHECK(alert.proposals[0].robot == "pioneer2");
  }
}

TEST_CASE("moves that people have decided do not count, and the file says how many do") {
  ResilienceSettings settings = automatic();
  settings.policy.max_moves = 1;
  auto bench = paper(settings);
  bench->view.decisions.push_back({2, "cloud", "a", "bob", "", 0, {{"t4", Ruling::move, "ridgeback", 2, {}}}});
  Decision decision;
  decision.epoch = 2;
  decision.run = kRun;
  SignedRecord record;
  record.payload.bytes = encode(decision);
  bench->decisions.push_back(record);
  bench->view.epoch = 2;
  bench->task("t4").attempt = 2;
  bench->changed();
  bench->end_task("t4", TaskOutcome::failed, "stuck");
  bench->wait(seconds(10));
  REQUIRE(bench->taken.size() == 1);
  bench->end_task("t4", TaskOutcome::failed, "stuck");
  bench->wait(seconds(10));
  CHECK(bench->taken.size() == 1);
  CHECK(bench->alert().policy == "automatic, but asks: it has moved task 't4' 1 times: a person decides");
}

TEST_CASE("a run with its 64 decisions takes no more: the verdict is refused when it is given") {
  auto bench = paper();
  fill_decisions(*bench, 63);
  bench->end_task("t4", TaskOutcome::failed, "stuck");
  CHECK(bench->decide(Verdict::retry) == "accepted");
  REQUIRE(bench->taken.size() == 1);
  bench->end_task("t4", TaskOutcome::failed, "stuck");
  for (const Verdict verdict : {Verdict::accept, Verdict::retry, Verdict::skip}) {
    CHECK(bench->decide(verdict) == "conflict");
    CHECK(bench->last_text.find("64 decisions") != std::string::npos);
    CHECK(bench->last_text.find("--abort") != std::string::npos);
  }
  CHECK(bench->alert().state == AlertState::open);
  CHECK(bench->heard["sign_request"] == 1);
  CHECK(bench->decide(Verdict::abort) == "accepted");
}

TEST_CASE("a decision that is being made counts among the 64") {
  auto bench = paper();
  fill_decisions(*bench, 63);
  bench->end_task("t4", TaskOutcome::failed, "stuck");
  bench->end_task("t5", TaskOutcome::failed, "stuck");
  bench->deaf = true;
  const auto alerts = bench->alerts();
  REQUIRE(alerts.size() == 2);
  CHECK(bench->decide(AlertDecide{alerts[0].id, Verdict::skip, "", "", "", false}) == "accepted");
  CHECK(bench->decide(AlertDecide{alerts[1].id, Verdict::skip, "", "", "", false}) == "conflict");
}

TEST_CASE("64 attempts of a task are the most: after them it can only be left out") {
  auto bench = paper();
  bench->task("t4").attempt = 64;
  bench->end_task("t4", TaskOutcome::failed, "stuck");
  for (const Verdict verdict : {Verdict::accept, Verdict::retry}) {
    CHECK(bench->decide(verdict) == "conflict");
    CHECK(bench->last_text.find("attempt 65") != std::string::npos);
    CHECK(bench->last_text.find("--skip") != std::string::npos);
  }
  CHECK(bench->decide(Verdict::skip) == "accepted");
  CHECK(bench->taken.at(0).tasks.at(0).attempt == 65);
}

TEST_CASE("attempts that its robot may have made unheard are no more than 64: it can still be left out") {
  auto bench = paper();
  bench->start.scenario.tasks[3].retries = 5;
  Decision decision;
  decision.epoch = 2;
  decision.run = kRun;
  SignedRecord record;
  record.payload.bytes = encode(decision);
  bench->decisions.push_back(record);
  bench->view.decisions.push_back({2, "cloud", "a", "bob", "", 0, {{"t4", Ruling::retry, "ridgeback", 62, {}}}});
  bench->view.epoch = 2;
  bench->task("t4").attempt = 64;
  bench->restart();
  bench->wait(seconds(6));
  bench->silence("ridgeback");
  AlertDecide word{bench->alert().id, Verdict::skip, "", "", "", true};
  word.tasks = {"t4"};
  CHECK(bench->decide(word) == "accepted");
  CHECK(bench->taken.at(0).tasks.at(0).attempt == 65);
}

TEST_CASE("a robot that is not there gets nothing, whatever the reason") {
  auto bench = paper();
  bench->silence("pioneer2");
  bench->end_task("t4", TaskOutcome::failed, "stuck");
  CHECK(bench->decide(Verdict::override_, "pioneer2", false, "it is mine") == "conflict");
  CHECK(bench->last_text.find("is not there") != std::string::npos);
  CHECK(bench->alert().verdict == Verdict::none);
}
