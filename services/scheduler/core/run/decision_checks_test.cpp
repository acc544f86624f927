#include "services/scheduler/core/run/decision_checks.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

Errc refusal(const KnownRun& known, std::vector<TaskRuling> rulings, const std::string& by = "cloud") {
  const auto checked = known.run().decision_checks().decision(known.decision(std::move(rulings), by));
  REQUIRE_FALSE(checked.ok());
  return checked.error().code;
}

Status grounds(const KnownRun& known, TaskRuling ruling) {
  const auto checked = known.run().decision_checks().decision(known.decision({std::move(ruling)}));
  REQUIRE_MESSAGE(checked.ok(), (checked ? "" : checked.error().text()));
  return known.run().decision_checks().grounds(*checked, known.run().facts());
}

}  // namespace

TEST_CASE("only the decider makes the next epoch") {
  const KnownRun known(chain({"ur3", "drone"}));
  const TaskRuling move{"task-1", Ruling::move, "ur3", 2, Evidence::word};
  CHECK(known.run().decision_checks().decision(known.decision({move})).ok());
  CHECK(refusal(known, {move}, "cloud2") == Errc::not_permitted);
  CHECK(refusal(known, {move}, "drone") == Errc::not_permitted);
}

TEST_CASE("a ruling names a task once, its next attempt, and a robot that can have it") {
  const KnownRun known(chain({"ur3", "drone"}));
  const TaskRuling move{"task-1", Ruling::move, "ur3", 2, Evidence::word};
  CHECK(refusal(known, {}) == Errc::bad_value);
  CHECK(refusal(known, {move, move}) == Errc::duplicate);
  CHECK(refusal(known, {{"none", Ruling::move, "ur3", 2, Evidence::word}}) == Errc::bad_value);
  CHECK(refusal(known, {{"task-1", Ruling::move, "ur3", 1, Evidence::word}}) == Errc::bad_value);
  CHECK(refusal(known, {{"task-1", Ruling::move, "drone", 2, Evidence::word}}) == Errc::bad_value);
  CHECK(refusal(known, {{"task-1", Ruling::move, "cloud2", 2, Evidence::word}}) == Errc::bad_value);
  CHECK(refusal(known, {{"task-1", Ruling::retry, "ur3", 2, Evidence::word}}) == Errc::bad_value);
  CHECK(refusal(known, {{"task-1", Ruling::skip, "ur3", 2, Evidence::word}}) == Errc::bad_value);
}

TEST_CASE("a decision is built on the one before") {
  KnownRun known(chain({"ur3", "drone"}));
  const SignedRecord early = known.decision({{"task-1", Ruling::move, "ur3", 2, Evidence::word}});
  known.decide({{"task-0", Ruling::move, "drone", 2, Evidence::word}});
  CHECK_FALSE(known.run().decision_checks().decision(early).ok());
  CHECK(known.run()
            .decision_checks()
            .decision(known.decision({{"task-1", Ruling::move, "ur3", 2, Evidence::word}}))
            .ok());
}

TEST_CASE("the decider rules on nothing that is final, and on a given up task only if it has been given up") {
  KnownRun known(chain({"ur3", "drone"}), "cloud");
  known.finish("task-0");
  CHECK_FALSE(grounds(known, {"task-0", Ruling::move, "drone", 2, Evidence::result}).ok());
  CHECK_FALSE(grounds(known, {"task-1", Ruling::move, "ur3", 2, Evidence::result}).ok());
  CHECK(grounds(known, {"task-1", Ruling::move, "ur3", 2, Evidence::word}).ok());
  known.add(known.result("task-1", "drone", TaskOutcome::failed));
  CHECK(grounds(known, {"task-1", Ruling::move, "ur3", 2, Evidence::result}).ok());
}
