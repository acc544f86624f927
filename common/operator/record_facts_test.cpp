#include "common/operator/record_facts.hpp"

#include <doctest/doctest.h>

#include "proto/body.hpp"

using namespace trb;
using namespace trb::op;

namespace {

SignedRecord abort(const std::string& by, const std::string& reason, std::int64_t time) {
  return {std::string(kSignedRunAbort), by, {encode(AbortOrder{"aa11", by, reason, time})}, {}};
}

SignedRecord result(const std::string& task, const std::string& robot, std::int64_t ended,
                    TaskOutcome outcome = TaskOutcome::finished) {
  TaskResult out;
  out.key = {"aa11", task, 1, 1};
  out.robot = robot;
  out.outcome = outcome;
  out.ended = ended;
  return {std::string(kSignedResult), robot, {encode(out)}, {}};
}

}  // namespace

TEST_CASE("the earliest order that ends a run tells who ended it, and why") {
  const RunRecords records{"aa11", 2, {abort("ur3", "task failed", 9), abort("cloud", "by olga: shift ends", 7)}};
  const auto ender = ender_of(records);
  REQUIRE(ender);
  CHECK(ender->node == "cloud");
  CHECK(ender->reason == "by olga: shift ends");
  CHECK(ender->time.ns == 7);
  CHECK_FALSE(ender_of({"aa11", 1, {result("b", "ur3", 1)}}));
  CHECK_FALSE(ender_of({"aa11", 1, {{std::string(kSignedRunAbort), "ur3", {"no order"}, {}}}}));
}

TEST_CASE("each robot that has done a task is told, in the order of their ends") {
  const RunRecords records{"aa11",
                           4,
                           {result("b", "turtlebot", 9), result("a", "ur3", 1), result("b", "pioneer1", 7),
                            result("b", "ur3", 8, TaskOutcome::failed)}};
  const auto doers = doers_of(records, "b");
  REQUIRE(doers.size() == 2);
  CHECK(doers[0].robot == "pioneer1");
  CHECK(doers[1].robot == "turtlebot");
  CHECK(doers_of(records, "c").empty());
}

TEST_CASE("records are read only where the view leaves something open") {
  RunView view;
  view.tasks.resize(2);
  CHECK_FALSE(needs_records(view));
  SUBCASE("who ended it") {
    view.state = RunState::aborted;
    CHECK(needs_records(view));
  }
  SUBCASE("who did a task that was moved") {
    view.tasks[1].moved_from = "pioneer1";
    CHECK_FALSE(needs_records(view));
    view.tasks[1].state = TaskState::finished;
    CHECK(needs_records(view));
  }
  SUBCASE("who did a task twice") {
    view.tasks[0].twice = true;
    CHECK(needs_records(view));
  }
}
