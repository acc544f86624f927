#include "services/scheduler/core/handlers/decision_handler.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

using Names = std::vector<std::string>;

const TaskRuling kMove{"task-1", Ruling::move, "ur3", 2, Evidence::word};

struct Deciding {
  explicit Deciding(const std::string& self) : known(chain({"ur3", "drone"}), self) {}
  KnownRun known;
  DecisionHandler handler{known.self, known.lookup, known.journal};
};

}  // namespace

TEST_CASE("a decision is journaled, and confirmed to whom it comes from as often as it comes") {
  Deciding member("ur3");
  const RunDecision body{member.known.decision({kMove})};
  const Outbox first = member.known.send(member.handler, "cloud", body);
  CHECK(first.journal.size() == 1);
  CHECK(targets<DecisionJournaled>(first) == Names{"cloud"});
  CHECK(member.known.run().epochs().current() == 2);
  const Outbox again = member.known.send(member.handler, "drone", body);
  CHECK(again.journal.empty());
  CHECK(targets<DecisionJournaled>(again) == Names{"drone"});
}

TEST_CASE("another decision of a known epoch is refused") {
  Deciding member("ur3");
  const SignedRecord other = member.known.decision({{"task-0", Ruling::move, "drone", 2, Evidence::word}});
  member.known.decide({kMove});
  CHECK(nacks(member.known.send(member.handler, "cloud", RunDecision{other})) == Names{"conflict"});
}

TEST_CASE("where it is made a decision rests on what is known, and is made on no run that is over") {
  Deciding decider("cloud");
  const RunDecision baseless{decider.known.decision({{"task-1", Ruling::move, "ur3", 2, Evidence::result}})};
  CHECK(nacks(decider.known.send(decider.handler, "cloud", baseless)) == Names{"conflict"});
  const RunDecision good{decider.known.decision({kMove})};
  CHECK(decider.known.send(decider.handler, "cloud", good).journal.size() == 1);
  REQUIRE(decider.known.run().apply(JournalAbort{decider.known.abort(), false}).ok());
  const RunDecision late{decider.known.decision({{"task-0", Ruling::move, "drone", 2, Evidence::word}})};
  CHECK(nacks(decider.known.send(decider.handler, "cloud", late)) == Names{"conflict"});
}

TEST_CASE("after a gap the sender is asked for the decisions between") {
  Deciding member("ur3");
  Deciding ahead("ur3");
  ahead.known.decide({kMove});
  Decision third =
      *decode<Decision>(ahead.known.decision({{"task-0", Ruling::move, "drone", 2, Evidence::word}}).payload.bytes);
  const RunDecision body{member.known.signers.sign("cloud", kSignedDecision, encode(third))};
  CHECK(targets<NeedDefinition>(member.known.send(member.handler, "cloud", body)) == Names{"cloud"});
}

TEST_CASE("only the decider asks for tasks back, in this epoch, and only this node's") {
  Deciding member("ur3");
  const auto ask = [&](const std::string& by, std::uint32_t epoch, TaskIndex task) {
    return nacks(member.known.send(member.handler, by, ReleaseTasks{kKnownRun, epoch, {task}}));
  };
  CHECK(ask("drone", 1, 0) == Names{"not_permitted"});
  CHECK(ask("cloud", 2, 0) == Names{"conflict"});
  CHECK(ask("cloud", 1, 1) == Names{"bad_value"});
  CHECK(ask("cloud", 1, 0).empty());
  CHECK(member.known.run().work().withheld().is_asked_back(0));
}

TEST_CASE("a decision is owed until it is journaled") {
  Deciding decider("cloud");
  decider.known.send(decider.handler, "cloud", RunDecision{decider.known.decision({kMove})});
  REQUIRE(decider.known.run().deliveries().pending().owes(DeliveryKind::decision, "drone"));
  decider.known.send(decider.handler, "drone", DecisionJournaled{kKnownRun, 1});
  CHECK(decider.known.run().deliveries().pending().owes(DeliveryKind::decision, "drone"));
  decider.known.send(decider.handler, "drone", DecisionJournaled{kKnownRun, 2});
  CHECK_FALSE(decider.known.run().deliveries().pending().owes(DeliveryKind::decision, "drone"));
}
