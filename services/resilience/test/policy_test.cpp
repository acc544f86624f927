// What a policy decides by itself, when it waits, and when it asks.
#include <doctest/doctest.h>

#include "services/resilience/test/wheels_fail.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

TEST_CASE("an automatic policy decides once the cause has shown all of its tasks") {
  auto fixture = paper(automatic());
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  fixture->wait(seconds(1));
  fixture->fault("ridgeback", "mobile");
  CHECK(fixture->taken.empty());
  fixture->wait(seconds(4));
  REQUIRE(fixture->taken.size() == 1);
  CHECK(rulings(fixture->taken[0]) == "t4>pioneer1 t7>pioneer1");
  CHECK(fixture->taken[0].person.empty());
  CHECK(fixture->any(fixture->taken[0].alert).policy == "automatic");
}

TEST_CASE("an automatic policy waits for who is proposed to say how it is, for 5 s") {
  for (const bool answers : {true, false}) {
    auto fixture = paper(automatic());
    fixture->wait(seconds(60));
    fixture->mute.insert("turtlebot");
    fixture->fault("ridgeback", "mobile");
    fixture->end_task("t4", TaskOutcome::failed, "stuck");
    fixture->wait(seconds(4));
    CHECK(fixture->alert().policy == "automatic, waits: what turtlebot answers");
    CHECK(fixture->taken.empty());
    if (answers) {
      for (const auto& [name, value] : fixture->values["turtlebot"]) fixture->answer("turtlebot", Opaque{name, value});
    } else {
      fixture->wait(seconds(2));
    }
    fixture->wait(seconds(1));
    CHECK(fixture->taken.size() == 1);
  }
}

TEST_CASE("a policy whose conditions do not hold asks, and says why") {
  const auto asks = [](ResilienceSettings settings) {
    auto fixture = paper(settings);
    wheels_fail(*fixture);
    fixture->wait(seconds(10));
    CHECK(fixture->taken.empty());
    return fixture->alert().policy;
  };
  CHECK(asks(automatic(0.95)).starts_with("automatic, but asks: the best has a merit of 0.92"));
  CHECK(asks(automatic(0, 0.5)).starts_with("automatic, but asks: the best leads by"));
  ResilienceSettings mild = automatic();
  mild.policy.max_severity = Severity::urgent;
  CHECK(asks(mild) == "automatic, but asks: the fault is CRITICAL");
  CHECK(asks(default_resilience()) == "ask");
}

TEST_CASE("a fault that gets worse makes its run's alert worse, and the policy leaves it to people from then on") {
  for (const bool was_lesser : {true, false}) {
    CAPTURE(was_lesser);
    ResilienceSettings settings = automatic();
    settings.policy.max_severity = Severity::critical;
    auto fixture = paper(settings);
    if (was_lesser) fixture->fault("ridgeback", "mobile");
    fixture->say("ridgeback", RobotFault{"mobile", Severity::fatal, "the motor burns"});
    fixture->settle();
    CHECK(fixture->run_alert().severity == Severity::fatal);
    CHECK(fixture->run_alert().text == "the motor burns");
    fixture->end_task("t4", TaskOutcome::failed, "mobile is broken");
    fixture->wait(seconds(10));
    CHECK(fixture->taken.empty());
    CHECK(fixture->run_alert().policy == "automatic, but asks: the fault is FATAL");
  }
}

TEST_CASE("what a FATAL fault has stopped is left to people though its robot is silent, too, or was") {
  ResilienceSettings settings = automatic();
  settings.policy.max_severity = Severity::critical;
  auto fixture = paper(settings);
  fixture->silence("ridgeback");
  fixture->end_task("t4", TaskOutcome::failed, "mobile is broken");
  fixture->settle();
  CHECK(fixture->run_alert().severity == Severity::critical);
  fixture->say("ridgeback", RobotFault{"mobile", Severity::fatal, "the motor burns"});
  fixture->settle();
  CHECK(fixture->run_alert().cause == "peer_expired");
  CHECK(fixture->run_alert().severity == Severity::fatal);
  fixture->back("ridgeback");
  fixture->wait(seconds(10));
  CHECK(fixture->run_alert().cause == "robot_fault");
  CHECK(fixture->run_alert().severity == Severity::fatal);
  CHECK(fixture->taken.empty());
}
