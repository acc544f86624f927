// From the verdict to the scheduler: releases, late and repeated messages, conflicts.
#include <doctest/doctest.h>

#include "services/resilience/test/fixture.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

std::unique_ptr<Fixture> broken(ResilienceSettings settings = default_resilience()) {
  auto fixture = paper(settings);
  fixture->fault("ridgeback", "mobile");
  fixture->end_task("t4", TaskOutcome::failed, "mobile is broken");
  return fixture;
}

/// Another node's decision: an epoch that this service has not made.
void decide_elsewhere(Fixture& fixture) {
  fixture.view.decisions.push_back({2, "cloud", "another", "bob", "", 0, {{"t4", Ruling::move, "turtlebot", 2, {}}}});
  fixture.view.epoch = 2;
  Decision decision;
  decision.epoch = 2;
  decision.run = kRun;
  SignedRecord record;
  record.payload.bytes = encode(decision);
  fixture.decisions.push_back(record);
  fixture.task("t4").robot = "turtlebot";
  fixture.task("t4").outcome = TaskOutcome::none;
  fixture.task("t4").state = TaskState::waiting;
  fixture.task("t4").attempt = 2;
  fixture.changed();
  fixture.settle();
}

}  // namespace

TEST_CASE("a robot that does not give its task back is asked again, with back-off, until it has") {
  auto fixture = broken();
  fixture->keeps.insert("ridgeback");
  const std::string id = fixture->alert().id;
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  CHECK(fixture->last_text.find("ridgeback to give task 't7' back") != std::string::npos);
  fixture->wait(seconds(10));
  CHECK(fixture->taken.empty());
  CHECK(fixture->any(id).state == AlertState::releasing);
  CHECK(fixture->releases.size() >= 5);
  CHECK(fixture->releases.size() <= 8);
  fixture->keeps.clear();
  fixture->wait(seconds(6));
  CHECK(rulings(fixture->taken.at(0)) == "t4>pioneer1 t7>pioneer1");
  const std::size_t asked = fixture->releases.size();
  fixture->wait(seconds(10));
  CHECK(fixture->releases.size() == asked);
}

TEST_CASE("a task that was begun meanwhile is waited for; if it finishes it is not moved") {
  auto fixture = paper();
  fixture->fault("ridgeback", "mobile");
  const std::string id = fixture->alert().id;
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  CHECK(fixture->any(id).waits_for == "task 't4' runs at ridgeback: its end");
  fixture->wait(seconds(3));
  CHECK(fixture->taken.empty());
  fixture->end_task("t4", TaskOutcome::finished);
  CHECK(rulings(fixture->taken.at(0)) == "t7>pioneer1");
}

TEST_CASE("if everything has finished meanwhile nothing is decided") {
  auto fixture = paper();
  fixture->keeps.insert("ridgeback");
  fixture->fault("ridgeback", "mobile");
  const std::string id = fixture->alert().id;
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  fixture->end_task("t4", TaskOutcome::finished);
  fixture->end_task("t7", TaskOutcome::finished);
  CHECK(fixture->taken.empty());
  CHECK(fixture->any(id).state == AlertState::closed);
}

TEST_CASE("a robot that falls silent while it is asked: a word may follow the verdict") {
  auto fixture = broken();
  fixture->keeps.insert("ridgeback");
  const std::string id = fixture->alert().id;
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  fixture->silence("ridgeback");
  fixture->wait(seconds(5));
  CHECK(fixture->any(id).waits_for.find("--stands") != std::string::npos);
  CHECK(fixture->taken.empty());
  CHECK(fixture->decide(AlertDecide{id, Verdict::accept, "", "", "", true}) == "accepted");
  REQUIRE(fixture->taken.size() == 1);
  CHECK(rulings(fixture->taken[0]) == "t4>pioneer1 t7>pioneer1?");
}

TEST_CASE("words that are said twice, too late or otherwise do no harm, and are told what was decided") {
  auto fixture = broken();
  fixture->keeps.insert("ridgeback");
  const std::string id = fixture->alert().id;
  CHECK(fixture->decide(AlertDecide{"nothing", Verdict::accept, "", "", "", false}) == "unknown_target");
  CHECK(fixture->decide(AlertDecide{"", Verdict::accept, "", "", "", false}) == "unknown_target");
  CHECK(fixture->decide(Verdict::none) == "missing");
  CHECK(fixture->decide(Verdict::accept, "ur3") == "bad_value");
  CHECK(fixture->decide(AlertDecide{id.substr(0, 6), Verdict::accept, "pioneer2", "", "", false}) == "accepted");
  CHECK(fixture->decide(Verdict::accept, "pioneer2") == "accepted");
  CHECK(fixture->last_text.find("already") != std::string::npos);
  CHECK(fixture->decide(Verdict::accept, "pioneer1") == "conflict");
  CHECK(fixture->last_text.find("t4 to pioneer2") != std::string::npos);
  CHECK(fixture->decide(Verdict::skip) == "conflict");
  fixture->keeps.clear();
  fixture->wait(seconds(6));
  CHECK(rulings(fixture->taken.at(0)) == "t4>pioneer2 t7>pioneer2");
  CHECK(fixture->decide(AlertDecide{id, Verdict::accept, "pioneer1", "", "", false}) == "conflict");
  CHECK(fixture->taken.size() == 1);
}

TEST_CASE("a task goes to no other robot than the person was shown") {
  auto fixture = broken();
  fixture->keeps.insert("ridgeback");
  const std::string id = fixture->alert().id;
  const Proposal best = fixture->alert().proposals.at(0);
  AlertDecide word{id, Verdict::accept, "", "", "", false};
  word.shown = {{"t4", best.robot}, {"t7", "pioneer2"}};
  CHECK(fixture->decide(word) == "conflict");
  CHECK(fixture->last_text.find("t4 to pioneer1, t7 to pioneer1") != std::string::npos);
  word.shown = best.tasks;
  fixture->silence(best.robot);  // the best is another one by now
  CHECK(fixture->decide(word) == "conflict");
  CHECK(fixture->any(id).verdict == Verdict::none);
  word.shown = {{"t4", "pioneer2"}, {"t7", "pioneer2"}, {"t1", "ur3"}};  // t1 has ended since
  CHECK(fixture->decide(word) == "accepted");
  CHECK(fixture->any(id).proposals.at(0).robot == "pioneer2");
  CHECK(fixture->decide(word) == "accepted");
  word.shown = {{"t4", "turtlebot"}, {"t7", "turtlebot"}};
  CHECK(fixture->decide(word) == "conflict");
  CHECK(fixture->last_text.find("t4 to pioneer2") != std::string::npos);
}

TEST_CASE("a verdict comes from the own node alone, and a robot's node decides nothing") {
  auto fixture = broken();
  const Alert alert = fixture->alert();
  fixture->settings.role = Role::robot;
  fixture->restart();
  fixture->wait(seconds(10));
  CHECK(fixture->alert().waits_for == "a verdict on node cloud");
  CHECK(fixture->decide(Verdict::accept) == "not_permitted");
  CHECK(fixture->taken.empty());
}

TEST_CASE("somebody else's epoch comes between: the alert is open again and says so") {
  auto fixture = broken();
  const std::string id = fixture->alert().id;
  fixture->refuses = "queue_full";  // not delivered: tried again
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  fixture->wait(seconds(2));
  CHECK(fixture->any(id).state == AlertState::releasing);
  decide_elsewhere(*fixture);
  const Alert alert = fixture->any(id);
  CHECK(alert.state == AlertState::open);
  CHECK(alert.verdict == Verdict::none);
  CHECK(alert.text.find("epoch 2 of its run is another decision") != std::string::npos);
  CHECK(alert.tasks == std::vector<std::string>{"t7"});
  fixture->refuses.clear();
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  REQUIRE(fixture->taken.size() == 1);
  CHECK(fixture->taken[0].epoch == 3);
  CHECK(rulings(fixture->taken[0]) == "t7>pioneer1");
}

TEST_CASE("a decision that the scheduler refuses for good opens the alert again, and the policy does not insist") {
  auto fixture = broken(automatic());
  fixture->refuses = "bad_value";
  fixture->wait(seconds(20));
  CHECK(fixture->heard["run_decision"] == 1);
  const Alert alert = fixture->alert();
  CHECK(alert.policy.find("its decision was refused") != std::string::npos);
  fixture->refuses.clear();
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  CHECK(fixture->taken.size() == 1);
}

TEST_CASE("who was chosen fails as well, before anything was signed: the alert is open again") {
  auto fixture = broken();
  fixture->keeps.insert("ridgeback");
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  fixture->silence("pioneer1");
  fixture->keeps.clear();
  fixture->wait(seconds(6));
  const Alert alert = fixture->alert();
  CHECK(alert.state == AlertState::open);
  CHECK(alert.text.find("pioneer1 cannot take over") != std::string::npos);
  CHECK(alert.proposals.front().robot == "pioneer2");
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  CHECK(rulings(fixture->taken.at(0)) == "t4>pioneer2 t7>pioneer2");
}

TEST_CASE("two robots fail in one run: two alerts, two decisions, one after the other") {
  auto fixture = paper(automatic());
  NodeProfile arm = fixture->routes["ur3"].profile;
  fixture->add("ur5", arm, 0, 0, 0);
  fixture->fault("ridgeback", "mobile");
  fixture->fault("ur3", "grab");
  fixture->end_task("t4", TaskOutcome::failed);
  CHECK(fixture->alerts().size() == 2);
  fixture->wait(seconds(10));
  REQUIRE(fixture->taken.size() == 2);
  CHECK(fixture->taken[1].epoch == 3);
  CHECK(fixture->taken[1].previous.bytes == digest(fixture->decisions[0].payload.bytes));
  CHECK(fixture->run_alerts().empty());
}

TEST_CASE("the run's end closes what is open") {
  auto fixture = broken();
  const std::string id = fixture->alert().id;
  fixture->view.state = RunState::aborted;
  fixture->changed();
  fixture->settle();
  CHECK(fixture->any(id).state == AlertState::closed);
  CHECK(fixture->decide(AlertDecide{id, Verdict::accept, "", "", "", false}) == "conflict");
}

TEST_CASE("a scheduler that knows no watch, or is away, is asked again, and the fleet is kept all the same") {
  auto fixture = std::make_unique<Fixture>();
  fixture->knows_watch = false;
  fixture->add("pioneer1", mobile_robot(), 80, 0, 0);
  fixture->wait(seconds(30));
  // After 0.2 s, doubled up to 1 s.
  CHECK(fixture->heard["run_watch"] >= 28);
  CHECK(fixture->heard["run_watch"] <= 36);
  fixture->fault("pioneer1", "mobile");
  fixture->wait(seconds(3));
  CHECK(fixture->alert().robot == "pioneer1");
}

TEST_CASE(
    "a scheduler that comes up after the resilience service is watched within a second, and again after its restart") {
  auto fixture = std::make_unique<Fixture>();
  const auto watches_within = [&](double wait_s) {
    const int before = fixture->heard["run_watch"];
    fixture->knows_watch = true;
    fixture->wait(seconds(wait_s));
    return fixture->heard["run_watch"] - before;
  };
  fixture->knows_watch = false;
  fixture->restart();
  fixture->wait(seconds(20));
  CHECK(watches_within(1) == 1);
  CHECK(watches_within(4) == 0);  // it is taken now, and told again only before it ends
  fixture->knows_watch = false;
  fixture->wait(seconds(3));
  CHECK(watches_within(2) >= 1);
}

TEST_CASE("a verdict on other tasks of an alert is another verdict, and not answered as if it had been taken") {
  auto fixture = broken();
  fixture->keeps.insert("ridgeback");
  const std::string id = fixture->alert().id;
  AlertDecide word{id, Verdict::accept, "pioneer2", "", "", false};
  word.tasks = {"t4"};
  CHECK(fixture->decide(word) == "accepted");
  CHECK(fixture->decide(word) == "accepted");
  CHECK(fixture->last_text.find("already") != std::string::npos);
  word.tasks = {"t7"};
  CHECK(fixture->decide(word) == "conflict");
}
