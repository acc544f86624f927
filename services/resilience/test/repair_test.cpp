// A person confirms that a robot is repaired: its node takes it into use, or refuses, or is not reached.
#include <doctest/doctest.h>

#include "services/resilience/test/fixture.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

TEST_CASE("retry tells the robot's node that it is repaired, again until its profile has the fault no more") {
  auto fixture = paper();
  fixture->stand("pioneer2", "mobile");
  fixture->wait(seconds(3));
  const std::string id = fixture->alert().id;
  fixture->idle.insert("pioneer2");
  CHECK(fixture->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  CHECK(fixture->last_text.find("pioneer2 to take 'mobile' into use") != std::string::npos);
  fixture->wait(seconds(10));
  CHECK(fixture->any(id).state == AlertState::releasing);
  REQUIRE(fixture->repairs.size() >= 4);
  CHECK(fixture->repairs[0].capability == "mobile");
  CHECK(fixture->repairs[0].by == "ann");
  CHECK(fixture->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  CHECK(fixture->last_text.find("already") != std::string::npos);
  fixture->restart();
  fixture->wait(seconds(5));
  CHECK(fixture->any(id).state == AlertState::releasing);
  fixture->idle.clear();
  fixture->wait(seconds(12));
  CHECK(fixture->any(id).state == AlertState::closed);
  CHECK(fixture->alerts().empty());
}

TEST_CASE("its answer is lost: it refuses what it has done already, and its profile has the last word") {
  auto fixture = paper();
  fixture->stand("pioneer2", "mobile");
  fixture->stand("pioneer2", "");
  fixture->wait(seconds(3));
  const std::string id = fixture->alert().id;
  fixture->mute.insert("pioneer2");
  CHECK(fixture->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  fixture->wait(seconds(12));
  CHECK(fixture->any(id).state == AlertState::closed);
  CHECK(fixture->any(id).text.find("does not take it") == std::string::npos);
  CHECK(fixture->alerts().empty());
  for (const TakeIntoUse& one : fixture->repairs) CHECK(one.capability.empty());
}

TEST_CASE("the robot's node refuses: the alert is open again and says why, and nobody else can refuse") {
  auto fixture = paper();
  fixture->stand("pioneer2", "mobile");
  fixture->wait(seconds(3));
  const std::string id = fixture->alert().id;
  fixture->silence("pioneer2");  // not delivered: sent again once it is back
  CHECK(fixture->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  fixture->wait(seconds(5));
  fixture->say("turtlebot", Nack{"conflict", "take_into_use", "pioneer2", "not so", ""});
  CHECK(fixture->any(id).state == AlertState::releasing);
  fixture->unmended.insert("pioneer2");
  fixture->back("pioneer2");
  fixture->wait(seconds(6));
  CHECK(fixture->any(id).state == AlertState::open);
  CHECK(fixture->any(id).text.find("the bumper is still pressed") != std::string::npos);
  CHECK(fixture->any(id).verdict == Verdict::none);
  fixture->wait(seconds(20));
  CHECK(fixture->repairs.size() == 1);
}

TEST_CASE("retry in a run: the robot's node takes it into use, then the task is tried again") {
  auto fixture = paper();
  fixture->stand("ridgeback", "mobile");
  fixture->end_task("t4", TaskOutcome::failed, "mobile is broken");
  fixture->wait(seconds(6));
  fixture->idle.insert("ridgeback");
  const std::string id = fixture->alert().id;
  CHECK(fixture->decide(Verdict::retry) == "accepted");
  fixture->wait(seconds(10));
  CHECK(fixture->taken.empty());
  CHECK(fixture->any(id).waits_for == "ridgeback to take 'mobile' into use");
  fixture->idle.clear();
  fixture->wait(seconds(10));
  CHECK(rulings(fixture->taken.at(0)) == "t4!ridgeback");
  CHECK(fixture->alerts().empty());
}

TEST_CASE("what breaks again before the task is tried again opens the alert: the word was on the repair before") {
  auto fixture = paper();
  fixture->end_task("t5", TaskOutcome::failed, "stuck");
  fixture->refuses = "queue_full";  // another alert's decision on the run is not accepted yet
  CHECK(fixture->decide(Verdict::skip) == "accepted");
  fixture->stand("ridgeback", "mobile");
  fixture->end_task("t4", TaskOutcome::failed, "mobile is broken");
  fixture->wait(seconds(6));
  std::string id;
  for (const Alert& one : fixture->alerts()) id = one.robot == "ridgeback" ? one.id : id;
  CHECK(fixture->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  fixture->wait(seconds(6));
  const std::size_t told = fixture->repairs.size();
  CHECK(fixture->any(id).waits_for.starts_with("the decision on alert"));
  fixture->stand("ridgeback", "mobile");
  fixture->wait(seconds(6));
  CHECK(fixture->repairs.size() == told);
  CHECK(fixture->any(id).state == AlertState::open);
  CHECK(fixture->any(id).text.find("is broken again: 'mobile'") != std::string::npos);
}

TEST_CASE("after its alert is done, retry speaks of the fault that still stands") {
  auto fixture = paper();
  fixture->stand("ridgeback", "mobile");
  fixture->end_task("t4", TaskOutcome::failed, "mobile is broken");
  const std::string id = fixture->alert().id;
  CHECK(fixture->decide(Verdict::accept) == "accepted");
  SUBCASE("an alert without a run tells of it by now") {
    fixture->wait(seconds(6));
    CHECK(fixture->alert().run.empty());
  }
  SUBCASE("none does yet") {
    fixture->wait(seconds(1));
  }
  CHECK(fixture->decide(AlertDecide{id, Verdict::retry, "", "", "", false}) == "accepted");
  fixture->wait(seconds(3));
  CHECK(fixture->repairs.size() == 1);
  CHECK(fixture->alerts().empty());
}

TEST_CASE("retry speaks of what its alert tells, and of nothing else that is broken") {
  auto fixture = paper();
  fixture->fault("ridgeback", "mobile");
  fixture->fault("ridgeback", "carry");
  fixture->wait(seconds(6));
  std::string other;
  for (const Alert& alert : fixture->alerts()) {
    if (alert.run.empty()) other = alert.capability;
  }
  REQUIRE_FALSE(other.empty());
  for (const Alert& alert : fixture->alerts()) {
    if (alert.run.empty())
      CHECK(fixture->decide(AlertDecide{alert.id, Verdict::retry, "", "", "", false}) == "accepted");
  }
  const Alert stays = fixture->run_alert();
  CHECK(stays.capability != other);
  CHECK(stays.cause == "robot_fault");
}
