#include "services/scheduler/core/run/signature.hpp"

#include <doctest/doctest.h>

#include <functional>

#include "tests/support/at.hpp"

using namespace trb;
using namespace trb::scheduler;

namespace {

using RunRecord = PendingSignatures::RunRecord;

std::size_t requests(const std::function<void(Outbox&)>& step) {
  Outbox out;
  step(out);
  return sent<SignRequest>(out).size();
}

SignedRecord record_of(std::string_view kind, const Bytes& payload) {
  return {std::string(kind), "ur3", {payload}, {"signature"}};
}

}  // namespace

TEST_CASE("the router is asked to sign at once, and again every 2 s") {
  Signature signature("run_end", "it is over", at(0));
  CHECK(requests([&](Outbox& out) { signature.tick("ur3", at(0), out); }) == 1);
  CHECK(requests([&](Outbox& out) { signature.tick("ur3", at(1.9), out); }) == 0);
  CHECK(requests([&](Outbox& out) { signature.tick("ur3", at(2), out); }) == 1);
  signature.restart(at(3));
  CHECK(requests([&](Outbox& out) { signature.tick("ur3", at(3), out); }) == 1);
  CHECK(signature.is_for(record_of("run_end", "it is over")));
  CHECK_FALSE(signature.is_for(record_of("run_end", "it is not")));
  CHECK_FALSE(signature.is_for(record_of("result", "it is over")));
}

TEST_CASE("a task's result is drafted once, whatever time goes by, until it is wanted no more") {
  PendingSignatures pending;
  int drafts = 0;
  const auto draft = [&] {
    TaskResult result;
    result.key = {"run", "pick", 1, 1};
    result.started = ++drafts;
    return result;
  };
  const auto want = [&](double s) {
    return requests([&](Outbox& out) { pending.want_result(4, draft, "ur3", at(s), out); });
  };
  CHECK(want(0) == 1);
  CHECK(want(1) == 0);
  CHECK(want(2) == 1);
  CHECK(drafts == 1);
  drafts = 0;
  CHECK(pending.result_for(record_of(kSignedResult, encode(draft()))) == TaskIndex{4});
  CHECK_FALSE(pending.result_for(record_of(kSignedResult, "another")).has_value());
  pending.keep_results({4});
  CHECK(pending.wants_results());
  pending.keep_results({5});
  CHECK_FALSE(pending.wants_results());
}

TEST_CASE("an order waits for its signature beside the others") {
  PendingSignatures pending;
  CHECK_FALSE(pending.next().has_value());
  pending.want(RunRecord::abort, {"run_abort", "stop", at(1)});
  CHECK(pending.wants(RunRecord::abort));
  CHECK_FALSE(pending.wants(RunRecord::hold));
  CHECK(pending.is_for(RunRecord::abort, record_of("run_abort", "stop")));
  CHECK_FALSE(pending.is_for(RunRecord::end, record_of("run_abort", "stop")));
  CHECK(pending.next() == at(1).mono);
  CHECK(requests([&](Outbox& out) { pending.tick(RunRecord::abort, "ur3", at(1), out); }) == 1);
  CHECK(requests([&](Outbox& out) { pending.tick(RunRecord::hold, "ur3", at(1), out); }) == 0);
  pending.drop(RunRecord::abort);
  CHECK_FALSE(pending.next().has_value());
}
