// What follows at the end of a step: results without an attempt, what is sent, and runs that leave.
#include <doctest/doctest.h>

#include "services/scheduler/core/delivery_sender.hpp"
#include "services/scheduler/core/run_archiver.hpp"
#include "services/scheduler/core/unattempted_results.hpp"
#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

using Names = std::vector<std::string>;

Outbox request(const UnattemptedResults& results, const KnownRun& known) {
  Outbox out;
  results.request(known.run(), known.step(out));
  return out;
}

Outbox send_due_of(const KnownRun& known) {
  Outbox out;
  send_due(known.run(), known.step(out));
  return out;
}

}  // namespace

TEST_CASE("what follows only skipped tasks is signed as SKIPPED, and kept") {
  KnownRun known(chain({"drone", "ur3"}));
  UnattemptedResults results(known.self, known.journal);
  known.decide({{"task-0", Ruling::skip, "cloud", 2, Evidence::word}});
  CHECK(request(results, known).sends.empty());
  known.add(known.result("task-0", "cloud", TaskOutcome::skipped, 2));
  const SignedRecord record = signed_by(known.signers, "ur3", request(results, known));
  Outbox out;
  CHECK(results.keep_signed(known.run(), record, known.step(out)));
  CHECK(known.run().results().is_skipped(1));
  CHECK_FALSE(results.keep_signed(known.run(), record, known.step(out)));
}

TEST_CASE("what is asked back is released; once the run is aborted nothing more is signed") {
  KnownRun known(chain({"ur3"}));
  UnattemptedResults results(known.self, known.journal);
  known.run().work().withheld().give_back({0});
  CHECK(sent<SignRequest>(request(results, known)).size() == 1);
  REQUIRE(known.run().apply(JournalAbort{known.abort(), false}).ok());
  CHECK(request(results, known).sends.empty());
  CHECK_FALSE(known.run().work().signatures().wants_results());
}

TEST_CASE("what is owed is sent with what belongs to it") {
  KnownRun known(chain({"ur3", "drone"}));
  known.finish("task-0");
  const Outbox out = send_due_of(known);
  CHECK(targets<Results>(out) == Names{"cloud", "cloud2"});
  REQUIRE(sent<Baton>(out).size() == 1);
  CHECK(sent<Baton>(out)[0].results.size() == 1);
  CHECK(send_due_of(known).sends.empty());
}

TEST_CASE("the decider passes on what nobody is known to have passed on, every 30 s") {
  KnownRun known(chain({"ur3", "drone"}), "cloud");
  known.finish("task-0");
  TaskTimers& timers = known.run().work().timers();
  timers.set_passes(known.run().deliveries().unpassed(), known.now.mono + seconds(30));
  CHECK(targets<Baton>(send_due_of(known)).empty());
  known.pass(30);
  CHECK(targets<Baton>(send_due_of(known)) == Names{"drone"});
  known.run().reports().note_progress(1, TaskState::running);
  CHECK(timers.next() == known.now.mono + seconds(30));
}

TEST_CASE("a run that is over goes to the archive after a minute, with all that was signed") {
  KnownRun known(chain({"ur3"}), "cloud");
  Watchers watchers;
  RunArchiver archiver(false, known.runs, known.executor, watchers);
  known.finish("task-0");
  REQUIRE(known.run().apply(JournalEnd{known.end()}).ok());
  Outbox first;
  archiver.archive_if_over(known.run(), known.step(first));
  CHECK(first.journal.empty());
  known.pass(60);
  Outbox out;
  archiver.archive_if_over(known.run(), known.step(out));
  REQUIRE(out.journal.size() == 1);
  const auto record = std::any_cast<JournalArchive>(out.journal[0].record);
  CHECK(record.results.size() == 1);
  CHECK(record.end.kind == kSignedRunEnd);
  CHECK(known.runs.runs().empty());
}

TEST_CASE("what is owed keeps an aborted run; an expired one gives its batons up") {
  KnownRun known(chain({"ur3"}));
  Watchers watchers;
  RunArchiver archiver(true, known.runs, known.executor, watchers);
  REQUIRE(known.run().apply(JournalAbort{known.abort(), false}).ok());
  for (int i = 0; i < 2; ++i) {
    Outbox out;
    archiver.archive_if_over(known.run(), known.step(out));
    known.pass(100);
  }
  CHECK(known.runs.runs().size() == 1);
  known.run().deliveries().pending().drop(DeliveryKind::abort);
  for (int i = 0; i < 2; ++i) {
    Outbox out;
    archiver.archive_if_over(known.run(), known.step(out));
    known.pass(100);
  }
  CHECK(known.runs.runs().empty());
}
