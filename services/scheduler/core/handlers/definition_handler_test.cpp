#include "services/scheduler/core/handlers/definition_handler.hpp"

#include <doctest/doctest.h>

#include "common/scenario/run_start.hpp"
#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

const std::string kNewRun(32, 'b');

/// Besides the known run there is another, unknown one.
struct Intake {
  SignedRecord new_start(Duration life = seconds(3600)) {
    return known.signers.make_start(chain({"drone"}), "ur3", known.now.utc, life, kNewRun);
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

namespace {

/// What is answered to the definition of a run of drone, whose baton has come.
struct Taking {
  Outbox take(const Definition& body) {
    Outbox out;
    Baton baton;
    baton.run = kNewRun;
    known.lookup.find_or_defer(kNewRun, {}, known.from("drone", MessageType::command, baton), known.step(out));
    return known.send(handler, "drone", body, MessageType::information, 5);
  }
  /// Of the cloud and the drone alone.
  [[nodiscard]] SignedRecord make_start() const {
    return known.signers.sign(
        "drone", kSignedRunStart,
        encode(build_run_start(chain({"drone"}), {known.signers.member("cloud"), known.signers.member("drone")},
                               "drone", known.now.utc, known.now.utc + seconds(3600), kNewRun)));
  }
  /// Moves the run's task to ur3.
  SignedRecord decision(const SignedRecord& given) {
    auto opened = known.runs.open(given);
    REQUIRE(opened.ok());
    Decision out;
    out.run = kNewRun;
    out.digest = (*opened)->definition().start().digest;
    out.epoch = 2;
    out.by = "cloud";
    out.tasks.push_back({"task-0", Ruling::move, "ur3", 2, Evidence::word});
    out.members.push_back(known.signers.member("ur3"));
    return known.signers.sign("cloud", kSignedDecision, encode(out));
  }

  KnownRun known{chain({"ur3", "drone"})};
  SignedRecord start = make_start();
  DefinitionHandler handler{known.self, known.runs, known.lookup, known.journal, [](const Inbound&, Step) {}};
};

}  // namespace

TEST_CASE("a run of which this node is no member is not taken, unless a decision makes it one") {
  Taking taking;
  const Outbox refused = taking.take(Definition{taking.start});
  CHECK(refused.journal.empty());
  CHECK(nacks(refused) == Codes{"not_permitted"});
  SignedRecord forged = taking.decision(taking.start);
  forged.signature.bytes[0] ^= 1;
  CHECK(taking.take(Definition{taking.start, {forged}}).journal.empty());
  CHECK(taking.known.runs.find(kNewRun) == nullptr);
  CHECK(taking.take(Definition{taking.start, {taking.decision(taking.start)}}).journal.size() == 2);
  REQUIRE(taking.known.runs.find(kNewRun) != nullptr);
  CHECK(taking.known.runs.find(kNewRun)->members().contains("ur3"));
}

TEST_CASE("a judge asks all members of a run that it learns of, unless its submitter passes it for the first time") {
  const auto learns_by = [](const std::string& giver, std::vector<TaskIndex> tasks) {
    KnownRun known(chain({"ur3"}), "cloud");
    DefinitionHandler handler{known.self, known.runs, known.lookup, known.journal, [](const Inbound&, Step) {}};
    const SignedRecord start = known.signers.make_start(chain({"ur3"}), "ur3", known.now.utc, seconds(3600), kNewRun);
    Baton baton;
    baton.run = kNewRun;
    baton.epoch = 1;
    baton.tasks = std::move(tasks);
    Outbox out;
    const Inbound first = known.from(giver, MessageType::command, baton);
    REQUIRE(known.lookup.find_or_defer(kNewRun, {}, first, known.step(out)) == nullptr);
    known.send(handler, giver, Definition{start}, MessageType::information, 5);
    return known.runs.find(kNewRun)->is_recovering();
  };
  CHECK_FALSE(learns_by("ur3", {}));
  CHECK(learns_by("ur3", {0}));
  CHECK(learns_by("drone", {}));
}

TEST_CASE("one submitter's runs take a quarter of the room that the others leave") {
  const KnownRun model(chain({"ur3"}));
  const std::size_t size = model.run().definition().record().payload.bytes.size();
  KnownRun known(chain({"ur3"}), "ur3", 7 * size);
  DefinitionHandler handler{known.self, known.runs, known.lookup, known.journal, [](const Inbound&, Step) {}};
  const auto submit = [&](const std::string& submitter, char letter) {
    const SignedRecord start =
        known.signers.make_start(chain({"ur3"}), submitter, known.now.utc, seconds(3600), std::string(32, letter));
    return nacks(known.send(handler, "ur3", RunSubmit{start}));
  };
  CHECK(submit("drone", 'b').empty());
  CHECK(submit("drone", 'c') == Codes{"queue_full"});
  CHECK(submit("pioneer", 'd').empty());
}

TEST_CASE("decisions are taken from a definition that was asked for") {
  Intake intake;
  const SignedRecord decision = intake.known.decision({{"task-1", Ruling::move, "pioneer", 2, Evidence::word}});
  const Definition body{intake.known.start, {decision}};
  CHECK(nacks(intake.known.send(intake.handler, "drone", body)) == Codes{"unknown_run"});
  CHECK(intake.known.run().epochs().current() == 1);
  intake.known.run().work().awaited().await_decisions("drone");
  intake.known.send(intake.handler, "drone", body, MessageType::information, 5);
  CHECK(intake.known.run().epochs().current() == 2);
}

namespace {

/// A node that has the baton of a run it does not know, and what it is answered.
struct Compact {
  Compact() {
    Baton baton;
    baton.run = kNewRun;
    requester.known.lookup.find_or_defer(kNewRun, {}, requester.known.from("drone", MessageType::command, baton),
                                         requester.known.step(asked));
    answer.start.payload = {};
    answer.compact = *compact_start(start, false);
  }
  Outbox hear(const Definition& body) {
    return requester.known.send(requester.handler, "drone", body, MessageType::information, 5);
  }
  /// Of the own router, which knows these nodes.
  Outbox tell_routes(const std::vector<std::string>& nodes) {
    RouteTable table;
    for (const std::string& node : nodes) {
      Route route;
      route.id = node;
      route.certificate = requester.known.signers.certificate(node);
      if (node == renewed) route.certificate.signature.bytes[0] ^= 1;
      table.routes.push_back(route);
    }
    Outbox effects;
    requester.handler.on_routes(table, requester.known.step(effects));
    return effects;
  }
  [[nodiscard]] std::vector<std::string> members() const {
    const RunStart read = *decode<RunStart>(start.payload.bytes);
    std::vector<std::string> ids;
    for (const Member& member : read.members) ids.push_back(member.id);
    return ids;
  }
  [[nodiscard]] bool is_known() const { return requester.known.runs.find(kNewRun) != nullptr; }

  Intake requester;
  std::string renewed;  ///< whose certificate is another one yet
  Outbox asked;
  SignedRecord start = requester.new_start();
  Definition answer{start};
};

using Targets = std::vector<std::string>;

}  // namespace

TEST_CASE("who knows the members is answered with a start without their certificates, who does not with the whole") {
  Intake intake;
  const auto ask = [&](bool compact) {
    const NeedDefinition body{kKnownRun, {}, compact};
    return sent<Definition>(intake.known.send(intake.handler, "drone", body, MessageType::request)).at(0);
  };
  CHECK(ask(true).start.payload.bytes.empty());
  CHECK(ask(true).start.signature == intake.known.start.signature);
  CHECK(ask(true).compact.bytes.size() * 3 < intake.known.start.payload.bytes.size());
  CHECK(ask(false).start == intake.known.start);
  CHECK(ask(false).compact.bytes.empty());
}

TEST_CASE("a compact start is opened with the certificates of the own router, which is asked the first time") {
  Compact story;
  CHECK(sent<NeedDefinition>(story.asked).at(0).compact);
  CHECK(targets<RouteListRequest>(story.hear(story.answer)) == Targets{story.requester.known.self});
  CHECK_FALSE(story.is_known());
  CHECK(story.tell_routes(story.members()).journal.size() == 1);
  REQUIRE(story.is_known());
  CHECK(story.requester.handed_out.size() == 1);
  CHECK((story.requester.known.runs.find(kNewRun)->definition().record() == story.start));
}

TEST_CASE("later starts are opened at once") {
  Compact story;
  story.tell_routes(story.members());
  CHECK(story.hear(story.answer).journal.size() == 1);
  CHECK(story.is_known());
}

TEST_CASE("with a member that its router does not know, or another certificate, the start is requested whole") {
  Compact story;
  std::vector<NeedDefinition> asked;
  SUBCASE("not known") {
    std::vector<std::string> nodes = story.members();
    nodes.pop_back();
    story.hear(story.answer);
    asked = sent<NeedDefinition>(story.tell_routes(nodes));
  }
  SUBCASE("the signature does not fit") {
    story.tell_routes(story.members());
    Definition forged = story.answer;
    forged.start.signature.bytes[5] ^= 1;
    CHECK(targets<RouteListRequest>(story.hear(forged)) == Targets{story.requester.known.self});
    asked = sent<NeedDefinition>(story.tell_routes(story.members()));
  }
  REQUIRE(asked.size() == 1);
  CHECK_FALSE(asked[0].compact);
  CHECK_FALSE(story.is_known());
  story.hear(Definition{story.start});
  CHECK(story.is_known());
  CHECK(story.requester.handed_out.size() == 1);
}

TEST_CASE("a compact start that nothing waits for, or that is none, is refused; one that comes again is kept once") {
  Compact story;
  const auto refused = [&](const Definition& body) {
    const Outbox effects = story.hear(body);
    return effects.journal.empty() && targets<RouteListRequest>(effects).empty() &&
           targets<NeedDefinition>(effects).empty();
  };
  Definition broken = story.answer;
  broken.compact.bytes.resize(broken.compact.bytes.size() / 2);
  CHECK(refused(broken));
  for (int i = 0; i < 3; ++i) story.hear(story.answer);
  CHECK(story.tell_routes(story.members()).journal.size() == 1);
  CHECK(story.is_known());
  CHECK(refused(story.answer));
}

TEST_CASE("a certificate that was renewed since is learnt from the own router, once for all that waits") {
  Compact story;
  const std::vector<std::string> members = story.members();
  // Known so far with another certificate, as it was before.
  story.renewed = members.back();
  story.tell_routes(members);
  CHECK(targets<RouteListRequest>(story.hear(story.answer)).size() == 1);
  CHECK_FALSE(story.is_known());
  story.renewed.clear();
  CHECK(sent<NeedDefinition>(story.tell_routes(members)).empty());
  CHECK(story.is_known());
}
