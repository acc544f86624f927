#include "services/scheduler/core/handlers/end_handler.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

using Names = std::vector<std::string>;

struct Ending {
  explicit Ending(const std::string& self) : known(chain({"ur3"}), self) {}
  Outbox seek() {
    Outbox out;
    if (known.run().epochs().judges_here()) {
      handler.sign_end(known.run(), known.step(out));
    } else {
      handler.request_end(known.run(), known.step(out));
    }
    return out;
  }
  /// Everything that the node owes was journaled elsewhere.
  void settle_all() {
    PendingDeliveries& pending = known.run().deliveries().pending();
    for (const DeliveryKind kind : {DeliveryKind::baton, DeliveryKind::results}) pending.drop(kind);
  }
  KnownRun known;
  EndHandler handler{known.self, known.runs, known.executor, known.lookup, known.journal};
};

}  // namespace

TEST_CASE("the judge says that a run has FINISHED once every result is held, and tells every member") {
  Ending judge("cloud");
  CHECK(judge.seek().sends.empty());
  judge.known.finish("task-0");
  const SignedRecord end = signed_by(judge.known.signers, "cloud", judge.seek());
  Outbox out;
  REQUIRE(judge.handler.keep_signed(judge.known.run(), end, judge.known.step(out)));
  CHECK(judge.known.run().orders().has_ended());
  CHECK(out.journal.size() == 1);
  CHECK(targets<RunOver>(out).size() == judge.known.run().members().ids().size() - 1);
  CHECK(judge.seek().sends.empty());
}

TEST_CASE("a run in which a task was done twice does not end before somebody has looked") {
  Ending judge("cloud");
  for (const char* data : {"", "again"}) {
    judge.known.add(judge.known.result("task-0", "ur3", TaskOutcome::finished, 1, data));
  }
  CHECK(judge.seek().sends.empty());
}

TEST_CASE("who has nothing left to do asks the judge after 30 s") {
  Ending member("ur3");
  member.known.finish("task-0");
  member.settle_all();
  CHECK(member.seek().sends.empty());
  member.known.pass(30);
  CHECK(targets<NeedEnd>(member.seek()) == Names{"cloud"});
}

TEST_CASE("who waits for a decision on its failed task asks, too: the run may have gone on and ended meanwhile") {
  Ending member("ur3");
  member.settle_all();
  CHECK(member.seek().sends.empty());
  member.known.pass(40);
  CHECK(member.seek().sends.empty());  // it has a task to do
  member.known.add(member.known.result("task-0", "ur3", TaskOutcome::failed));
  member.settle_all();
  CHECK(member.seek().sends.empty());
  member.known.pass(30);
  CHECK(targets<NeedEnd>(member.seek()) == Names{"cloud"});
}

TEST_CASE("the judge's word ends a run, another's is refused, and a late one is counted") {
  Ending member("ur3");
  CHECK(nacks(member.known.send(member.handler, "cloud2", RunOver{member.known.end("cloud2")})) ==
        Names{"not_permitted"});
  const RunOver word{member.known.end()};
  CHECK(member.known.send(member.handler, "cloud2", word).journal.size() == 1);
  CHECK(member.known.send(member.handler, "cloud", word).counts == Names{"late.run_over"});
}

TEST_CASE("who asks for the end is told it, or that the run goes on") {
  Ending judge("cloud");
  const auto ask = [&] { return judge.known.send(judge.handler, "ur3", NeedEnd{kKnownRun}, MessageType::request); };
  CHECK(sent<Ack>(ask()).at(0).state == "not_over");
  REQUIRE(judge.known.run().apply(JournalEnd{judge.known.end()}).ok());
  CHECK(targets<RunOver>(ask()) == Names{"ur3"});
}

TEST_CASE("who asks for the end of an aborted run gets the order, unless it is owed anyway") {
  Ending judge("cloud");
  const auto ask = [&] { return judge.known.send(judge.handler, "ur3", NeedEnd{kKnownRun}, MessageType::request); };
  CHECK(targets<RunAbort>(ask()).empty());
  REQUIRE(judge.known.run().apply(JournalAbort{judge.known.abort(), true}).ok());
  CHECK(targets<RunAbort>(ask()).empty());
  REQUIRE(judge.known.run().deliveries().settle(DeliveryKind::abort, "ur3", {}));
  CHECK(targets<RunAbort>(ask()) == Names{"ur3"});
}
