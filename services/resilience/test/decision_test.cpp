// From the verdict to the scheduler: releases, late and repeated words, conflicts.
#include <doctest/doctest.h>

#include "services/resilience/test/bench.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

std::unique_ptr<Bench> broken(ResilienceSettings settings = default_resilience()) {
  auto bench = paper(settings);
  bench->fault("ridgeback", "mobile");
  bench->end_task("t4", TaskOutcome::failed, "mobile is broken");
  return bench;
}

/// Somebody else's decision: an epoch that this service has not made.
void decide_elsewhere(Bench& bench) {
  bench.view.decisions.push_back({2, "cloud", "another", "bob", "", 0, {{"t4", Ruling::move, "turtlebot", 2, {}}}});
  bench.view.epoch = 2;
  Decision decision;
  decision.epoch = 2;
  decision.run = kRun;
  SignedRecord record;
  record.payload.bytes = encode(decision);
  bench.decisions.push_back(record);
  bench.task("t4").robot = "turtlebot";
  bench.task("t4").outcome = TaskOutcome::none;
  bench.task("t4").state = TaskState::waiting;
  bench.task("t4").attempt = 2;
  bench.changed();
  bench.settle();
}

}  // namespace

TEST_CASE("a robot that does not give its task back is asked again, with back-off, until it has") {
  auto bench = broken();
  bench->keeps.insert("ridgeback");
  const std::string id = bench->alert().id;
  CHECK(bench->decide(Verdict::accept) == "accepted");
  CHECK(bench->last_text.find("ridgeback to give task 't7' back") != std::string::npos);
  bench->wait(seconds(10));
  CHECK(bench->taken.empty());
  CHECK(bench->any(id).state == AlertState::releasing);
  CHECK(bench->releases.size() >= 5);
  CHECK(bench->releases.size() <= 8);
  bench->keeps.clear();
  bench->wait(seconds(6));
  CHECK(rulings(bench->taken.at(0)) == "t4>pioneer1 t7>pioneer1");
  const std::size_t asked = bench->releases.size();
  bench->wait(seconds(10));
  CHECK(bench->releases.size() == asked);
}

TEST_CASE("a task that was begun meanwhile is waited for; if it finishes it is not moved") {
  auto bench = paper();
  bench->fault("ridgeback", "mobile");
  const std::string id = bench->alert().id;
  CHECK(bench->decide(Verdict::accept) == "accepted");
  CHECK(bench->any(id).waits_for == "task 't4' runs at ridgeback: its end");
  bench->wait(seconds(3));
  CHECK(bench->taken.empty());
  bench->end_task("t4", TaskOutcome::finished);
  CHECK(rulings(bench->taken.at(0)) == "t7>pioneer1");
}

TEST_CASE("if everything has finished meanwhile nothing is decided") {
  auto bench = paper();
  bench->keeps.insert("ridgeback");
  bench->fault("ridgeback", "mobile");
  const std::string id = bench->alert().id;
  CHECK(bench->decide(Verdict::accept) == "accepted");
  bench->end_task("t4", TaskOutcome::finished);
  bench->end_task("t7", TaskOutcome::finished);
  CHECK(bench->taken.empty());
  CHECK(bench->any(id).state == AlertState::closed);
}

TEST_CASE("a robot that falls silent while it is asked: a word may follow the verdict") {
  auto bench = broken();
  bench->keeps.insert("ridgeback");
  const std::string id = bench->alert().id;
  CHECK(bench->decide(Verdict::accept) == "accepted");
  bench->silence("ridgeback");
  bench->wait(seconds(5));
  CHECK(bench->any(id).waits_for.find("--stands") != std::string::npos);
  CHECK(bench->taken.empty());
  CHECK(bench->decide(AlertDecide{id, Verdict::accept, "", "", "", true}) == "accepted");
  REQUIRE(bench->taken.size() == 1);
  CHECK(rulings(bench->taken[0]) == "t4>pioneer1 t7>pioneer1?");
}

TEST_CASE("words that are said twice, too late or otherwise do no harm, and are told what was decided") {
  auto bench = broken();
  bench->keeps.insert("ridgeback");
  const std::string id = bench->alert().id;
  CHECK(bench->decide(AlertDecide{"nothing", Verdict::accept, "", "", "", false}) == "unknown_target");
  CHECK(bench->decide(AlertDecide{"", Verdict::accept, "", "", "", false}) == "unknown_target");
  CHECK(bench->decide(Verdict::none) == "missing");
  CHECK(bench->decide(Verdict::accept, "ur3") == "bad_value");
  CHECK(bench->decide(AlertDecide{id.substr(0, 6), Verdict::accept, "pioneer2", "", "", false}) == "accepted");
  CHECK(bench->decide(Verdict::accept, "pioneer2") == "accepted");
  CHECK(bench->last_text.find("already") != std::string::npos);
  CHECK(bench->decide(Verdict::accept, "pioneer1") == "conflict");
  CHECK(bench->last_text.find("t4 to pioneer2") != std::string::npos);
  CHECK(bench->decide(Verdict::skip) == "conflict");
  bench->keeps.clear();
  bench->wait(seconds(6));
  CHECK(rulings(bench->taken.at(0)) == "t4>pioneer2 t7>pioneer2");
  CHECK(bench->decide(AlertDecide{id, Verdict::accept, "pioneer1", "", "", false}) == "conflict");
  CHECK(bench->taken.size() == 1);
}

TEST_CASE("a verdict comes from the own node alone, and a robot's node decides nothing") {
  auto bench = broken();
  const Alert alert = bench->alert();
  bench->settings.role = Role::robot;
  bench->restart();
  bench->wait(seconds(10));
  CHECK(bench->alert().waits_for == "a verdict on node cloud");
  CHECK(bench->decide(Verdict::accept) == "not_permitted");
  CHECK(bench->taken.empty());
}

TEST_CASE("somebody else's epoch comes between: the alert is open again and says so") {
  auto bench = broken();
  const std::string id = bench->alert().id;
  bench->refuses = "queue_full";  // not delivered: tried again
  CHECK(bench->decide(Verdict::accept) == "accepted");
  bench->wait(seconds(2));
  CHECK(bench->any(id).state == AlertState::releasing);
  decide_elsewhere(*bench);
  const Alert alert = bench->any(id);
  CHECK(alert.state == AlertState::open);
  CHECK(alert.verdict == Verdict::none);
  CHECK(alert.text.find("epoch 2 of its run is another decision") != std::string::npos);
  CHECK(alert.tasks == std::vector<std::string>{"t7"});
  bench->refuses.clear();
  CHECK(bench->decide(Verdict::accept) == "accepted");
  REQUIRE(bench->taken.size() == 1);
  CHECK(bench->taken[0].epoch == 3);
  CHECK(rulings(bench->taken[0]) == "t7>pioneer1");
}

TEST_CASE("a decision that the scheduler refuses for good opens the alert again, and the policy does not insist") {
  auto bench = broken(automatic());
  bench->refuses = "bad_value";
  bench->wait(seconds(20));
  CHECK(bench->heard["run_decision"] == 1);
  const Alert alert = bench->alert();
  CHECK(alert.policy.find("its decision was refused") != std::string::npos);
  bench->refuses.clear();
  CHECK(bench->decide(Verdict::accept) == "accepted");
  CHECK(bench->taken.size() == 1);
}

TEST_CASE("who was chosen fails as well, before anything was signed: the alert is open again") {
  auto bench = broken();
  bench->keeps.insert("ridgeback");
  CHECK(bench->decide(Verdict::accept) == "accepted");
  bench->silence("pioneer1");
  bench->keeps.clear();
  bench->wait(seconds(6));
  const Alert alert = bench->alert();
  CHECK(alert.state == AlertState::open);
  CHECK(alert.text.find("pioneer1 cannot take over") != std::string::npos);
  CHECK(alert.proposals.front().robot == "pioneer2");
  CHECK(bench->decide(Verdict::accept) == "accepted");
  CHECK(rulings(bench->taken.at(0)) == "t4>pioneer2 t7>pioneer2");
}

TEST_CASE("two robots fail in one run: two alerts, two decisions, one after the other") {
  auto bench = paper(automatic());
  NodeProfile arm = bench->routes["ur3"].profile;
  bench->add("ur5", arm, 0, 0, 0);
  bench->fault("ridgeback", "mobile");
  bench->fault("ur3", "grab");
  bench->end_task("t4", TaskOutcome::failed);
  CHECK(bench->alerts().size() == 2);
  bench->wait(seconds(10));
  REQUIRE(bench->taken.size() == 2);
  CHECK(bench->taken[1].epoch == 3);
  CHECK(bench->taken[1].previous.bytes == digest(bench->decisions[0].payload.bytes));
  CHECK(bench->run_alerts().empty());
}

TEST_CASE("the run's end closes what is open") {
  auto bench = broken();
  const std::string id = bench->alert().id;
  bench->view.state = RunState::aborted;
  bench->changed();
  bench->settle();
  CHECK(bench->any(id).state == AlertState::closed);
  CHECK(bench->decide(AlertDecide{id, Verdict::accept, "", "", "", false}) == "conflict");
}

TEST_CASE("a scheduler that knows no watch, or is away, is asked again, and the fleet is kept all the same") {
  auto bench = std::make_unique<Bench>();
  bench->knows_watch = false;
  bench->add("pioneer1", mobile_robot(), 80, 0, 0);
  bench->wait(seconds(30));
  CHECK(bench->heard["run_watch"] >= 5);
  CHECK(bench->heard["run_watch"] <= 8);
  bench->fault("pioneer1", "mobile");
  bench->wait(seconds(3));
  CHECK(bench->alert().robot == "pioneer1");
}
