// A robot that is silent, and one that comes back: when that is an alert, and when it is none.
#include <doctest/doctest.h>

#include "services/resilience/test/wheels_fail.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

TEST_CASE("a robot that falls silent: its tasks move on a person's word alone") {
  auto fixture = paper(automatic());
  fixture->silence("ridgeback");
  const Alert alert = fixture->alert();
  CHECK(alert.cause == "peer_expired");
  CHECK(alert.capability.empty());
  CHECK(alert.tasks == Words{"t4", "t7", "t9"});
  CHECK(alert.needs_word);
  CHECK(alert.waits_for.find("ridgeback is silent: --stands if you have seen that ridgeback stands") !=
        std::string::npos);
  CHECK(alert.unfit.size() >= 1);
  CHECK(alert.proposals.empty());  // no other robot loads
  fixture->add("husky", carrier(), 50, 0, 0);
  fixture->wait(seconds(10));
  CHECK(fixture->taken.empty());
  CHECK(fixture->alert().policy == "automatic, but asks: only a person can say that ridgeback stands");
  CHECK(fixture->decide(Verdict::accept) == "bad_value");
  CHECK(fixture->last_text.find("--stands") != std::string::npos);
  CHECK(fixture->decide(Verdict::accept, "husky", true) == "accepted");
  CHECK(rulings(fixture->taken.at(0)) == "t4>husky? t7>husky? t9>husky?");
  CHECK(fixture->releases.empty());
}

TEST_CASE("a robot that comes back before anything was decided closes its alert; one whose task has failed does not") {
  auto fixture = paper();
  fixture->silence("ridgeback");
  const std::string id = fixture->alert().id;
  fixture->back("ridgeback");
  CHECK(fixture->alerts().empty());
  CHECK(fixture->any(id).state == AlertState::closed);

  fixture->silence("ridgeback");
  fixture->end_task("t4", TaskOutcome::interrupted, "nobody knows");
  fixture->back("ridgeback");
  const Alert alert = fixture->alert();
  CHECK(alert.tasks == Words{"t4"});
  CHECK(alert.needs_word);
  // It answers; what became of its task is not known all the same.
  CHECK(alert.waits_for.find("; nobody knows what became of task 't4': --stands if") != std::string::npos);
  CHECK(alert.cause == "peer_expired");
  CHECK(alert.text == "no longer so: its node is not reached");
  fixture->silence("ridgeback");
  CHECK(fixture->alert().text == "its node is not reached");
  fixture->back("ridgeback");
  CHECK(fixture->alert().text == "no longer so: its node is not reached");
  // go_to may be repeated: the robot may try again without a person's statement.
  CHECK(fixture->decide(Verdict::retry) == "accepted");
  CHECK(rulings(fixture->taken.at(0)) == "t4!ridgeback");
}

TEST_CASE("a connection that is broken for less than the grace is no alert") {
  auto fixture = paper();
  const auto connection = [&](const std::string& state) {
    fixture->routes["ridgeback"].profile.robot = state;
    fixture->say("ridgeback", RobotConnection{state, ""});
  };
  connection("CONNECTION_BROKEN");
  fixture->wait(seconds(4));
  connection("ONLINE");
  fixture->wait(seconds(20));
  CHECK(fixture->alerts(true).empty());
  connection("CONNECTION_BROKEN");
  fixture->wait(seconds(6));
  CHECK(fixture->alert().cause == "robot_connection");
  CHECK_FALSE(fixture->alert().needs_word);  // its node can still give tasks back
  connection("ONLINE");
  CHECK(fixture->alerts().empty());
}

TEST_CASE("a robot that is back before the grace is over is no alert, though nobody heard it say so") {
  auto fixture = paper();
  fixture->routes["ridgeback"].profile.robot = "";  // its router has restarted and has no profile yet
  fixture->say("cloud", PeerJoined{"ridgeback", 2});
  fixture->wait(seconds(2));
  fixture->routes["ridgeback"].profile.robot = "ONLINE";
  fixture->wait(seconds(20));
  CHECK(fixture->alerts(true).empty());
}

TEST_CASE("a robot that the own router knows no more is reached no more, though nobody says that it has expired") {
  auto fixture = paper();
  const Route route = fixture->routes.at("ridgeback");
  fixture->routes.erase("ridgeback");  // the own router has started anew: it finds the robot after some seconds
  fixture->wait(seconds(8));
  fixture->routes["ridgeback"] = route;
  fixture->wait(seconds(30));
  CHECK(fixture->alerts(true).empty());
  fixture->routes.erase("ridgeback");  // and again, and the robot is gone meanwhile
  fixture->wait(seconds(60));
  const Alert alert = fixture->alert();
  CHECK(alert.robot == "ridgeback");
  CHECK(alert.cause == "peer_expired");
  CHECK(alert.needs_word);
}
