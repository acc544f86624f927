#include "services/scheduler/core/run/record_checks.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/test/condition_story.hpp"
#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

template <class T>
Errc code_of(const Result<T>& result) {
  REQUIRE_FALSE(result.ok());
  return result.error().code;
}

}  // namespace

TEST_CASE("a result is believed from the task's robot alone") {
  const KnownRun known(chain({"ur3", "drone"}));
  const RecordChecks& checks = known.run().checks();
  CHECK(checks.result(known.result("task-1", "drone", TaskOutcome::finished)).ok());
  CHECK(code_of(checks.result(known.result("task-1", "ur3", TaskOutcome::finished))) == Errc::not_permitted);
  CHECK(code_of(checks.result(known.result("task-1", "drone", TaskOutcome::none))) == Errc::bad_value);
  CHECK(code_of(checks.result(known.result("task-1", "drone", TaskOutcome::failed, kMaxAttempts + 1))) ==
        Errc::bad_value);
  SignedRecord forged = known.result("task-1", "drone", TaskOutcome::finished);
  forged.signature.bytes[3] ^= 1;
  CHECK_FALSE(checks.result(forged).ok());
}

TEST_CASE("of a result that another node sends the attempt is one that its robot had in that epoch") {
  Scenario scenario = chain({"ur3", "drone"});
  scenario.tasks[1].retries = 2;
  KnownRun known(scenario);
  const RecordChecks& checks = known.run().checks();
  const auto received = [&](const std::string& robot, TaskOutcome outcome, std::uint32_t attempt) {
    return checks.received_result(known.result("task-1", robot, outcome, attempt));
  };
  CHECK(received("drone", TaskOutcome::finished, 3).ok());
  CHECK(code_of(received("drone", TaskOutcome::finished, 4)) == Errc::bad_value);
  CHECK(received("drone", TaskOutcome::skipped, 4).ok());
  CHECK(code_of(received("drone", TaskOutcome::failed, 64)) == Errc::bad_value);
  // Who was replaced counts on as far as its own retries go; its successor begins where the decision says.
  const SignedRecord late = known.result("task-1", "drone", TaskOutcome::failed, 3);
  const SignedRecord forged = known.result("task-1", "drone", TaskOutcome::failed, 64);
  known.decide({{"task-1", Ruling::move, "ur3", 4, Evidence::word}});
  CHECK(checks.received_result(late).ok());
  CHECK(code_of(checks.received_result(forged)) == Errc::bad_value);
  CHECK(received("ur3", TaskOutcome::finished, 4).ok());
  CHECK(code_of(received("ur3", TaskOutcome::finished, 3)) == Errc::bad_value);
  // Also a journal in which it counted further drives nobody's attempts up.
  known.add(forged);
  CHECK(known.run().facts().next_attempt(known.task("task-1")) == 4);
}

TEST_CASE("one robot's results of a run take 4 MiB: more is not received, others' is") {
  Scenario scenario = chain(std::vector<std::string>(70, "drone"));
  scenario.tasks[69].robot = "ridgeback";
  KnownRun known(scenario);
  const std::string data(65536, 'x');
  const auto result_of = [&](int task, const std::string& robot) {
    return known.result("task-" + std::to_string(task), robot, TaskOutcome::finished, 1, data);
  };
  int taken = 0;
  while (taken < 69 && known.run().received_result(result_of(taken, "drone")).ok())
    known.add(result_of(taken++, "drone"));
  CHECK(taken == 64);
  CHECK(code_of(known.run().received_result(result_of(64, "drone"))) == Errc::too_large);
  CHECK(known.run().received_result(result_of(3, "drone")).ok());
  CHECK(known.run().received_result(result_of(69, "ridgeback")).ok());
}

TEST_CASE("a robot that signs one attempt again and again, each time smaller, has 4 MiB as well") {
  KnownRun known(chain({"ur3", "drone"}));
  const auto signed_anew = [&](int number) {
    return known.result("task-1", "drone", TaskOutcome::failed, 1, std::to_string(number) + std::string(65'000, 'x'));
  };
  int number = 999;
  while (number > 800 && known.run().received_result(signed_anew(number)).ok()) known.add(signed_anew(number--));
  CHECK(999 - number == 65);
  CHECK(code_of(known.run().received_result(signed_anew(number))) == Errc::too_large);
  // What is held, or changes nothing, comes with others' batons: it is no reason to refuse them.
  CHECK(known.run().received_result(signed_anew(number + 1)).ok());
  CHECK(known.run().received_result(signed_anew(999)).ok());
  CHECK(code_of(known.run().received_result(known.result("task-1", "drone", TaskOutcome::finished))) ==
        Errc::too_large);
}

TEST_CASE("a cloud node can skip a task that a decision gives it, and do nothing else") {
  KnownRun known(chain({"ur3"}));
  known.decide({{"task-0", Ruling::skip, "cloud", 2, Evidence::word}});
  CHECK(known.run().checks().result(known.result("task-0", "cloud", TaskOutcome::skipped, 2)).ok());
  CHECK(code_of(known.run().checks().result(known.result("task-0", "cloud", TaskOutcome::finished, 2))) ==
        Errc::not_permitted);
}

TEST_CASE("a choice is believed from who evaluates the condition, if its own reading says so") {
  const KnownRun known(left_or_right(), "ridgeback");
  const RecordChecks& checks = known.run().checks();
  CHECK(checks.choice(known.choice("ridgeback", "left", 15)).ok());
  CHECK(code_of(checks.choice(known.choice("ur3", "left", 15))) == Errc::not_permitted);
  Choice lie = *decode<Choice>(known.choice("ridgeback", "left", 15).payload.bytes);
  lie.tasks.front().holds = false;
  CHECK(code_of(checks.choice(known.signers.sign("ridgeback", kSignedChoice, encode(lie)))) == Errc::bad_value);
}

TEST_CASE("any member may order to hold or to abort; a bad number is refused") {
  const KnownRun known(chain({"ur3"}));
  const RecordChecks& checks = known.run().checks();
  CHECK(checks.pause(known.pause(1, true, {}, "drone")).ok());
  CHECK(code_of(checks.pause(known.pause(0, true))) == Errc::bad_value);
  CHECK(code_of(checks.pause(known.pause(kMaxPauses + 1, true))) == Errc::bad_value);
  CHECK(checks.pause(known.pause(kMaxPauses + 1, false)).ok());
  CHECK(code_of(checks.pause(known.pause(kMaxPauses + 2, false))) == Errc::bad_value);
  CHECK(checks.abort(known.abort("drone")).ok());
  CHECK(checks.order(known.abort("drone")).ok());
  CHECK(checks.order(known.pause(1, false)).ok());
}

TEST_CASE("a robot's numbers end before a cloud's: what a cloud holds beyond them no robot lets go") {
  const KnownRun known(chain({"ur3"}));
  const RecordChecks& checks = known.run().checks();
  CHECK(checks.pause(known.pause(kMaxRobotResume, false, {}, "drone")).ok());
  CHECK(checks.pause(known.pause(kMaxRobotHold, true, {}, "drone")).ok());
  const auto beyond = checks.pause(known.pause(kMaxRobotResume + 1, false, {}, "drone"));
  CHECK(code_of(beyond) == Errc::bad_value);
  CHECK(beyond.error().text().find("'drone' to let it go on: number 1002 is not one of 1 to 1001") !=
        std::string::npos);
  CHECK(beyond.error().text().find("say it on node 'cloud'") != std::string::npos);
  CHECK(code_of(checks.pause(known.pause(kMaxRobotHold + 1, true, {}, "drone"))) == Errc::bad_value);
  // Also a cloud node that is not the judge outranks robots; a stranger outranks nobody.
  CHECK(checks.pause(known.pause(kMaxRobotHold + 1, true, {}, "cloud2")).ok());
  CHECK_FALSE(checks.outranks_robots("stranger"));
}

TEST_CASE("only the judge holds a run for what was done twice, and no robot's order says that somebody has looked") {
  const KnownRun known(chain({"ur3", "drone"}));
  const RecordChecks& checks = known.run().checks();
  const auto hold = [&](std::vector<std::string> doubles, const std::string& by) {
    return checks.received_pause(known.pause(1, true, std::move(doubles), by));
  };
  const auto resume = [&](std::vector<std::string> doubles, const std::string& by) {
    return checks.received_pause(known.pause(1, false, std::move(doubles), by));
  };
  CHECK(hold({"task-0", "task-1"}, "cloud").ok());
  CHECK(code_of(hold({"task-0"}, "cloud2")) == Errc::not_permitted);
  CHECK(code_of(hold({"task-0"}, "ur3")) == Errc::not_permitted);
  CHECK(hold({}, "ur3").ok());
  CHECK(resume({"task-0"}, "cloud").ok());
  CHECK(resume({"task-0"}, "cloud2").ok());
  CHECK(code_of(resume({"task-0"}, "ur3")) == Errc::not_permitted);
  CHECK(resume({"task-0"}, "ur3").error().hint == "look at the robots, then say it on node 'cloud'");
  CHECK(resume({}, "ur3").ok());
  CHECK(code_of(hold({"x"}, "cloud")) == Errc::bad_value);
  CHECK(code_of(resume({"task-0", "task-0"}, "cloud")) == Errc::bad_value);
  CHECK(code_of(checks.received_pause(known.pause(0, true))) == Errc::bad_value);
  // A journal of an earlier version may have such an order.
  CHECK(checks.pause(known.pause(1, true, {"x"}, "ur3")).ok());
  CHECK(checks.order(known.pause(1, true, {"task-0"}, "ur3")).error().code == Errc::not_permitted);
}

TEST_CASE("only the judge says that a run has FINISHED") {
  const KnownRun known(chain({"ur3"}));
  CHECK(known.run().checks().end(known.end()).ok());
  CHECK(code_of(known.run().checks().end(known.end("cloud2"))) == Errc::not_permitted);
}
