#include "services/scheduler/core/handlers/definition_handler.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

const std::string kNewRun(32, 'b');

/// Besides the known run there is another, unknown one.
struct Intake {
  SignedRecord new_start(Duration life = seconds(3600)) {
    return known.signers.fleet.make_start(chain({"drone"}), "ur3", life, kNewRun);
  }

  KnownRun known{chain({"ur3", "drone"})};
  std::vector<Inbound> handed_out;
  DefinitionHandler handler{known.self, known.runs, known.lookup, known.journal,
                            [this](const Inbound& message, Step) { handed_out.push_back(message); }};
};

using Codes = std::vector<std::string>;

}  // namespace

TEST_CASE("a run that is submitted on its own node is journaled and accepted, any number of times") {
  Intake intake;
  const Outbox first = intake.known.send(intake.handler, "ur3", RunSubmit{intake.new_start()});
  REQUIRE(first.journal.size() == 1);
  CHECK(std::any_cast<JournalRun>(first.journal[0].record).submitted_here);
  CHECK(nacks(first).empty());
  const SignedRecord same = intake.known.runs.find(kNewRun)->definition().record();
  const Outbox again = intake.known.send(intake.handler, "ur3", RunSubmit{same});
  CHECK(again.journal.empty());
  CHECK(nacks(again).empty());
}

TEST_CASE("a run is not taken from another node, with another start, or past its time") {
  Intake intake;
  CHECK(nacks(intake.known.send(intake.handler, "drone", RunSubmit{intake.new_start()})) == Codes{"not_permitted"});
  const SignedRecord other = intake.known.signers.start(chain({"pioneer"}));
  CHECK(nacks(intake.known.send(intake.handler, "ur3", RunSubmit{other})) == Codes{"conflict"});
  const SignedRecord brief = intake.new_start(seconds(1));
  intake.known.pass(2);
  CHECK(nacks(intake.known.send(intake.handler, "ur3", RunSubmit{brief})) == Codes{"expired"});
  CHECK(intake.known.runs.find(kNewRun) == nullptr);
}

TEST_CASE("a member that asks is answered with the start, the decisions and the orders") {
  Intake intake;
  intake.known.decide({{"task-1", Ruling::move, "pioneer", 2, Evidence::word}});
  REQUIRE(intake.known.run().apply(JournalAbort{intake.known.abort(), false}).ok());
  const Outbox out = intake.known.send(intake.handler, "drone", NeedDefinition{kKnownRun, {}}, MessageType::request);
  const auto answers = sent<Definition>(out);
  REQUIRE(answers.size() == 1);
  CHECK(answers[0].start == intake.known.start);
  CHECK(answers[0].decisions.size() == 1);
  CHECK(answers[0].orders.size() == 1);
}

TEST_CASE("a definition is taken only if a message waits for it, and that is handed out then") {
  Intake intake;
  const SignedRecord start = intake.new_start();
  const auto answer = [&] {
    return intake.known.send(intake.handler, "drone", Definition{start}, MessageType::information, 5);
  };
  answer();
  CHECK(intake.known.runs.find(kNewRun) == nullptr);
  Outbox out;
  Baton baton;
  baton.run = kNewRun;
  intake.known.lookup.find_or_defer(kNewRun, {}, intake.known.from("drone", MessageType::command, baton),
                                    intake.known.step(out));
  CHECK(targets<NeedDefinition>(out) == std::vector<std::string>{"drone"});
  CHECK(answer().journal.size() == 1);
  CHECK(intake.known.runs.find(kNewRun) != nullptr);
  CHECK(intake.handed_out.size() == 1);
}

TEST_CASE("decisions are taken from a definition that was asked for") {
  Intake intake;
  const SignedRecord decision = intake.known.decision({{"task-1", Ruling::move, "pioneer", 2, Evidence::word}});
  const Definition body{intake.known.start, {decision}};
  CHECK(nacks(intake.known.send(intake.handler, "drone", body)) == Codes{"unknown_run"});
  CHECK(intake.known.run().epochs().current() == 1);
  intake.known.run().work().requests().await_decisions("drone");
  intake.known.send(intake.handler, "drone", body, MessageType::information, 5);
  CHECK(intake.known.run().epochs().current() == 2);
}
