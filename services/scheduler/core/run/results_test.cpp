#include "services/scheduler/core/run/results.hpp"

#include <doctest/doctest.h>

#include "proto/body.hpp"

using namespace trb;
using namespace trb::scheduler;

namespace {

HeldResult held(std::uint32_t attempt, TaskOutcome outcome, const std::string& data = "") {
  TaskResult result;
  result.key = {"run", "task", 1, attempt};
  result.outcome = outcome;
  result.data = data;
  return {{"result", "ur3", {encode(result)}, {"signature"}}, result};
}

}  // namespace

TEST_CASE(
    "the first FINISHED result counts, else the latest attempt's; FINISHED is never lost to others of its attempt") {
  ResultSet set;
  CHECK(set.of(0) == nullptr);
  CHECK(set.add(0, held(2, TaskOutcome::failed)));
  CHECK(set.add(0, held(1, TaskOutcome::retriable)));
  CHECK_FALSE(set.add(0, held(1, TaskOutcome::retriable)));
  CHECK(set.of(0)->result.outcome == TaskOutcome::failed);
  CHECK_FALSE(set.has_final(0));
  CHECK(set.add(0, held(1, TaskOutcome::finished)));
  CHECK(set.has_final(0));
  CHECK_FALSE(set.finished_twice(0));
  CHECK(set.add(0, held(1, TaskOutcome::finished, "other")));
  CHECK(set.finished_twice(0));
  CHECK(set.final_tasks(2) == std::vector<bool>{true, false});
  for (const char* data : {"", "a", "b"}) set.add(0, held(1, TaskOutcome::failed, data));
  CHECK(set.finished_twice(0));
}

TEST_CASE("what proves a task's end: the result that counts, and another FINISHED one, the own rather than a third's") {
  const auto by = [](const std::string& robot, std::uint32_t attempt, TaskOutcome outcome) {
    HeldResult out = held(attempt, outcome);
    out.result.robot = robot;
    out.record.payload.bytes = encode(out.result);
    return out;
  };
  const auto attempts = [](const std::vector<const HeldResult*>& proof) {
    std::vector<std::uint32_t> out;
    for (const HeldResult* one : proof) out.push_back(one->result.key.attempt);
    return out;
  };
  using Attempts = std::vector<std::uint32_t>;
  ResultSet set;
  CHECK(set.proof_of(0, "ur3").empty());
  set.add(0, by("ur3", 1, TaskOutcome::retriable));
  CHECK(attempts(set.proof_of(0, "ur3")) == Attempts{1});
  set.add(0, by("drone", 2, TaskOutcome::finished));
  CHECK(attempts(set.proof_of(0, "ur3")) == Attempts{2});
  set.add(0, by("pioneer", 3, TaskOutcome::finished));
  set.add(0, by("ur3", 4, TaskOutcome::finished));
  CHECK(attempts(set.proof_of(0, "ur3")) == Attempts{2, 4});
  CHECK(attempts(set.proof_of(0, "drone")) == Attempts{2, 3});
}

TEST_CASE("what was FINISHED is not SKIPPED, whoever said that first") {
  for (const bool skipped_first : {true, false}) {
    ResultSet set;
    for (const bool skipped : {skipped_first, !skipped_first}) {
      set.add(0, skipped ? held(1, TaskOutcome::skipped) : held(2, TaskOutcome::finished));
    }
    CHECK(set.of(0)->result.outcome == TaskOutcome::finished);
    CHECK_FALSE(set.is_skipped(0));
  }
}

TEST_CASE("of what is not final the latest epoch's counts: who was replaced may have tried on") {
  const auto of_epoch = [](std::uint32_t epoch, std::uint32_t attempt) {
    HeldResult out = held(attempt, TaskOutcome::retriable);
    out.result.epoch = epoch;
    out.result.robot = epoch == 1 ? "ur3" : "drone";
    out.record.payload.bytes = encode(out.result);
    return out;
  };
  ResultSet set;
  set.add(0, of_epoch(1, 3));
  set.add(0, of_epoch(2, 2));
  CHECK(set.of(0)->result.epoch == 2);
  CHECK(set.holds(0, {"run", "task", 1, 2}, "drone"));
  CHECK_FALSE(set.holds(0, {"run", "task", 1, 2}, "ur3"));
}

TEST_CASE("an endless signer fills nothing") {
  ResultSet set;
  for (int i = 0; i < 100; ++i) set.add(0, held(1, TaskOutcome::failed, std::to_string(100 + i)));
  CHECK_FALSE(set.add(0, held(1, TaskOutcome::failed, "150")));
  CHECK(set.add(0, held(2, TaskOutcome::finished)));
  CHECK(set.has_final(0));
}

TEST_CASE("what has pushed out others of its attempt takes room like them: each was journaled") {
  ResultSet set;
  constexpr int kEach = 10'000;
  for (int i = 99; i > 0; --i) {
    CHECK(set.add(0, held(1, TaskOutcome::failed, std::to_string(100 + i) + std::string(kEach, 'x'))));
  }
  CHECK(set.bytes_of("") > 99 * kEach);
}
