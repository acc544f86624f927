#include "services/scheduler/core/run/pending_work.hpp"

#include <doctest/doctest.h>

#include "tests/support/at.hpp"

using namespace trb;
using namespace trb::scheduler;

TEST_CASE("a run that is over leaves after its grace, unless something comes between") {
  PendingWork work;
  CHECK_FALSE(work.may_leave(at(0).mono, seconds(60)));
  CHECK(work.next() == at(60).mono);
  CHECK_FALSE(work.may_leave(at(59).mono, seconds(60)));
  work.stay();
  CHECK_FALSE(work.may_leave(at(60).mono, seconds(60)));
  CHECK(work.may_leave(at(120).mono, seconds(60)));
}

TEST_CASE("every member that has passed on an abort is confirmed once") {
  PendingWork work;
  work.note_abort_from("drone");
  work.note_abort_from("drone");
  CHECK(work.take_unconfirmed() == std::set<std::string>{"drone"});
  CHECK(work.take_unconfirmed().empty());
}

TEST_CASE("a task that a decision has ruled on begins anew") {
  PendingWork work;
  work.withheld().fail(1, "late");
  work.timers().retry_at(1, at(5).mono);
  work.begin_anew(1);
  CHECK_FALSE(work.withheld().contains(1));
  CHECK_FALSE(work.timers().waits(1));
}

TEST_CASE("results, signatures and values that are waited for keep a run from being idle") {
  PendingWork work;
  CHECK(work.is_empty());
  work.awaited().need_result(1, "drone", "cloud");
  CHECK_FALSE(work.is_empty());
  work.awaited().drop_results();
  work.inquiries().emplace_back("ur3", Condition{});
  CHECK_FALSE(work.is_empty());
}

TEST_CASE("back at its router the service asks everything again") {
  PendingWork work;
  work.signatures().want(PendingSignatures::RunRecord::end, {"run_end", "payload", at(0)});
  Outbox out;
  work.signatures().tick(PendingSignatures::RunRecord::end, "ur3", at(0), out);
  CHECK(work.next() == at(2).mono);
  work.restart(at(1));
  CHECK(work.next() == at(1).mono);
}
