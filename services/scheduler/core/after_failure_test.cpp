#include "services/scheduler/core/after_failure.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

using namespace trb;
using namespace trb::scheduler;

namespace {

struct Row {
  TaskOutcome how{};
  FailureRules rules;
  TaskOutcome outcome{};
  bool goes_on = false;
};

void check(const std::vector<Row>& table) {
  for (const Row& row : table) {
    const FailureRules& rules = row.rules;
    CAPTURE(std::string(name_of(row.how)));
    CAPTURE(std::string(name_of(rules.on_failure)));
    CAPTURE(static_cast<int>(rules.permit));
    CAPTURE(rules.may_retry);
    CAPTURE(rules.repeatable);
    const AfterFailure after = after_failure(row.how, rules);
    CHECK(name_of(after.outcome) == name_of(row.outcome));
    CHECK(after.goes_on == row.goes_on);
  }
}

constexpr auto kFailed = TaskOutcome::failed;
constexpr auto kInterrupted = TaskOutcome::interrupted;
constexpr auto kRetriable = TaskOutcome::retriable;
constexpr auto kSkipped = TaskOutcome::skipped;
constexpr OnFailure kEach[] = {OnFailure::resilience, OnFailure::skip, OnFailure::abort, OnFailure::continue_};

}  // namespace

TEST_CASE("a failed task is tried again while its robot may, whatever the skill") {
  for (const OnFailure then : kEach) {
    check({
        {kFailed, {.may_retry = true, .repeatable = false, .on_failure = then}, kRetriable},
        {kFailed, {.may_retry = true, .repeatable = true, .on_failure = then}, kRetriable},
        {kFailed, {.permit = Permit::hold, .may_retry = true, .on_failure = then}, kRetriable},
        {kFailed, {.permit = Permit::give_back, .may_retry = true, .on_failure = then}, kRetriable},
        {kFailed, {.permit = Permit::no_more, .may_retry = true, .on_failure = then}, kRetriable},
    });
  }
}

TEST_CASE("an interrupted task is tried again only if doing it twice does no harm") {
  check({
      {kInterrupted, {.may_retry = true, .repeatable = true}, kRetriable},
      {kInterrupted, {.may_retry = true, .repeatable = false}, kInterrupted},
      {kInterrupted, {.may_retry = true, .repeatable = false, .on_failure = OnFailure::skip}, kSkipped},
      {kInterrupted, {.may_retry = false, .repeatable = true}, kInterrupted},
  });
}

TEST_CASE("without tries left the task's on_failure decides: skipped, gone on behind, or as it is") {
  check({
      {kFailed, {.on_failure = OnFailure::resilience}, kFailed},
      {kFailed, {.on_failure = OnFailure::abort}, kFailed},
      {kFailed, {.on_failure = OnFailure::skip}, kSkipped},
      {kFailed, {.on_failure = OnFailure::continue_}, kSkipped, true},
      {kInterrupted, {.on_failure = OnFailure::resilience}, kInterrupted},
      {kInterrupted, {.on_failure = OnFailure::abort}, kInterrupted},
      {kInterrupted, {.on_failure = OnFailure::skip}, kSkipped},
      {kInterrupted, {.on_failure = OnFailure::continue_}, kSkipped, true},
  });
}

TEST_CASE("what is too late is not tried again") {
  check({
      {kFailed, {.permit = Permit::too_late, .may_retry = true}, kFailed},
      {kFailed, {.permit = Permit::too_late, .may_retry = true, .on_failure = OnFailure::continue_}, kSkipped, true},
  });
}

TEST_CASE("who is ordered to stop has not failed by itself: nothing is skipped") {
  for (const OnFailure then : kEach) {
    for (const bool may_retry : {false, true}) {
      check({
          {kFailed, {Permit::stop, may_retry, true, then}, kRetriable},
          {kInterrupted, {Permit::stop, may_retry, true, then}, kInterrupted},
          {kFailed, {Permit::cancel, may_retry, true, then}, kFailed},
          {kInterrupted, {Permit::cancel, may_retry, true, then}, kInterrupted},
      });
    }
  }
}

TEST_CASE("an outcome that is no failure stands") {
  for (const OnFailure then : kEach) {
    for (const TaskOutcome how : {TaskOutcome::finished, kRetriable, TaskOutcome::released}) {
      check({{how, {.may_retry = true, .repeatable = true, .on_failure = then}, how},
             {how, {.permit = Permit::too_late, .on_failure = then}, how}});
    }
  }
}
