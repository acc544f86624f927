#include "common/model/own_protocol.hpp"

#include <doctest/doctest.h>

#include <set>
#include <string>

#include "proto/travel.hpp"

using namespace trb;
using namespace trb::model;

namespace {

/// Five robots, nine tasks in turn, each robot let go between its tasks, half a minute.
const OwnParameters kInTurn{.robots = 5, .tasks = 9, .members = 5, .batons = 9, .spells = 9, .seconds = 30};

double value_of(std::string_view subtype, const OwnParameters& p) {
  for (const OwnTerm& term : own_terms()) {
    if (term.subtype == subtype) return term.value(p);
  }
  FAIL("no term ", std::string(subtype));
  return 0;
}

}  // namespace

TEST_CASE("each term by hand: five robots, nine tasks in turn") {
  REQUIRE(check(kInTurn).ok());
  // 15 links of 6 nodes.
  CHECK(value_of("hello", kInTurn) == 30);
  CHECK(value_of("beacon", kInTurn) == doctest::Approx(6 * 9.3));
  CHECK(value_of("keep_alive", kInTurn) == 30 * 11.5);
  // Nine times busy, nine times free, to five other nodes.
  CHECK(value_of("node_profile", kInTurn) == 90);
  CHECK(value_of("results", kInTurn) == 9);
  CHECK(value_of("baton", kInTurn) == 9);
  CHECK(value_of("definition", kInTurn) == 5);
  CHECK(value_of("need_definition", kInTurn) == 5);
  CHECK(value_of("task_progress", kInTurn) == 18);
  CHECK(value_of("run_over", kInTurn) == 5);
  CHECK(value_of("robot_fault", kInTurn) == 0);
  // Keep-alives, Hellos, profiles, batons, results and their acknowledgements, four ends beside the last result.
  CHECK(value_of("seal", kInTurn) == 345 + 30 + 90 + 9 + 18 + 4);
}

TEST_CASE("a robot that breaks costs its fault, the decision and its tasks' new way") {
  OwnParameters p = kInTurn;
  p.faulty = 1;
  p.asked = 8;
  REQUIRE(check(p).ok());
  CHECK(own_messages(CostPhase::fail, p) == 5 + 1 + 5);
  CHECK(value_of("node_profile", p) == 95);
  CHECK(value_of("values", p) == 16);
  CHECK(own_messages(CostPhase::task, p) == 11 + 16);
  CHECK(own_messages(CostPhase::forward, p) == 10 + 6 + 6);
}

TEST_CASE("a task that names no robot costs the cloud's decision") {
  OwnParameters p{
      .robots = 3, .tasks = 3, .members = 2, .batons = 3, .spells = 2, .bound = 1, .asked = 4, .seconds = 30};
  REQUIRE(check(p).ok());
  CHECK(value_of("baton", p) == 4);
  CHECK(value_of("need_definition", p) == 3);
  CHECK(value_of("run_decision", p) == 2);
  CHECK(value_of("decision_journaled", p) == 2);
  CHECK(value_of("values", p) == 8);
  p.states = 2;
  CHECK(value_of("robot_state", p) == 6);
}

TEST_CASE("a robot that waits for the run's end asks for it, and hears that it is not over") {
  OwnParameters p = kInTurn;
  p.end_asked = 3;
  REQUIRE(check(p).ok());
  CHECK(value_of("need_end", p) == 3);
  CHECK(value_of("ack", p) == 3);
  CHECK(value_of("seal", p) == value_of("seal", kInTurn) + 6);
}

TEST_CASE("sensors: each that is plugged in is told, a request has an answer, updates go by time") {
  OwnParameters p = kInTurn;
  p.sensors = 2;
  p.remote_requests = 3;
  p.updates = 0.5;
  CHECK(value_of("node_profile", p) == 100);
  CHECK(value_of("sensor_read", p) == 3);
  CHECK(value_of("sensor_reading", p) == 3 + 15);
}

TEST_CASE("the phases' messages are all of them, of words that the protocol has") {
  double sum = 0;
  for (std::size_t i = 0; i < enum_names(CostPhase{}).size(); ++i)
    sum += own_messages(static_cast<CostPhase>(i), kInTurn);
  CHECK(sum == doctest::Approx(own_total(kInTurn)));
  std::set<std::string_view> seen;
  for (const OwnTerm& term : own_terms()) {
    CAPTURE(term.subtype);
    CHECK(seen.insert(term.subtype).second);
    CHECK((find_travel(term.subtype) != nullptr || term.subtype == "values"));
  }
}

TEST_CASE("bad parameters are refused by name") {
  struct Case {
    OwnParameters p;
    std::string name;
  };
  for (const auto& [p, name] : {
           Case{{.robots = 0}, "--robots"},
           Case{{.robots = kMaxRobots + 1}, "--robots"},
           Case{{.robots = 2, .tasks = kMaxCount + 1}, "--tasks"},
           Case{{.robots = 2, .tasks = 3, .members = 3}, "--members"},
           Case{{.robots = 2, .tasks = 3, .spells = 4}, "--spells"},
           Case{{.robots = 2, .tasks = 3, .batons = 1, .kept = 2}, "--kept"},
           Case{{.robots = 2, .tasks = 3, .batons = 1, .twice = 2}, "--twice"},
           Case{{.robots = 2, .tasks = 3, .resumed = 4}, "--resumed"},
           Case{{.robots = 2, .tasks = 3, .faulty = 2}, "--faulty"},
           Case{{.robots = 2, .faulty = 1}, "--faulty"},
           Case{{.robots = 2, .tasks = 3, .asked = 2}, "--asked"},
           Case{{.robots = 2, .tasks = 3, .bound = 4}, "--bound"},
           Case{{.robots = 2, .end_asked = 1}, "--end-asked"},
           Case{{.robots = 3, .tasks = 1, .members = 1, .crossed = 7}, "--crossed"},
           Case{{.robots = 2}, "--tasks"},
           Case{{.robots = 2, .tasks = 1}, "--members"},
           Case{{.seconds = -1}, "--seconds"},
           Case{{.updates = 1e300, .seconds = 1}, "--rate"},
           Case{{.updates = 1e8, .seconds = 1e8}, "--rate"},
       }) {
    const std::string parameter = name;
    CAPTURE(parameter);
    const Status status = check(p);
    REQUIRE_FALSE(status.ok());
    CHECK(status.error().what.find(name) != std::string::npos);
    CHECK_FALSE(status.error().hint.empty());
  }
}
