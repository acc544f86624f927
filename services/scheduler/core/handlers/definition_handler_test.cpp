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

namespace {

/// A node that is asked, and one that has the baton of a run it does not know.
struct Compact {
  Compact() {
    intake.known.journal.add(std::move(*intake.known.runs.open(start)), false, intake.known.step(out));
    known_there = get<Definition>(ask(true).sends.at(0).body);
    other.known.lookup.find_or_defer(kNewRun, {}, baton, other.known.step(out = {}));
  }
  Outbox ask(bool compact) {
    return intake.known.send(intake.handler, "drone", NeedDefinition{kNewRun, {}, compact}, MessageType::request);
  }
  Outbox answer(const Definition& body) {
    Outbox effects;
    other.handler.handle(body, other.known.from("drone", MessageType::information, body, 5), other.known.step(effects));
    return effects;
  }
  Outbox tell_routes(const std::vector<std::string>& nodes) {
    RouteTable table;
    for (const std::string& node : nodes) {
      Route route;
      route.id = node;
      route.certificate = certificate_of(node);
      table.routes.push_back(route);
    }
    Outbox effects;
    other.handler.on_routes(table, other.known.step(effects));
    return effects;
  }
  [[nodiscard]] SignedRecord certificate_of(const std::string& node) const {
    for (const Member& member : decode<RunStart>(start.payload.bytes)->members) {
      if (member.id == node) return member.certificate;
    }
    return {};
  }
  [[nodiscard]] std::vector<std::string> members() const {
    std::vector<std::string> out_of;
    for (const Member& member : decode<RunStart>(start.payload.bytes)->members) out_of.push_back(member.id);
    return out_of;
  }
  [[nodiscard]] bool is_known() const { return other.known.runs.find(kNewRun) != nullptr; }

  Intake intake;
  Intake other;
  Outbox out;
  SignedRecord start = intake.new_start();
  Inbound baton = other.known.from("drone", MessageType::command, [] {
    Baton body;
    body.run = kNewRun;
    return body;
  }());
  Definition known_there;
};

}  // namespace

TEST_CASE("a node that knows the members gets a start without their certificates, and opens it with its own") {
  Compact story;
  CHECK(sent<NeedDefinition>(story.out).at(0).compact);
  CHECK(story.known_there.start.payload.bytes.empty());
  const std::size_t whole = story.start.payload.bytes.size();
  CHECK(story.known_there.compact.bytes.size() * 3 < whole);
  CHECK(sent<Definition>(story.ask(false)).at(0).compact.bytes.empty());

  // The first time the own router is asked; from then on they are known.
  CHECK(targets<RouteListRequest>(story.answer(story.known_there)) == std::vector<std::string>{story.other.known.self});
  CHECK_FALSE(story.is_known());
  CHECK(story.tell_routes(story.members()).journal.size() == 1);
  CHECK(story.is_known());
  CHECK(story.other.handed_out.size() == 1);
  CHECK((story.other.known.runs.find(kNewRun)->definition().record() == story.start));
}

TEST_CASE("with a member that its router does not know, or whose certificate differs, the start is requested whole") {
  Compact story;
  SUBCASE("not known") {
    std::vector<std::string> nodes = story.members();
    nodes.pop_back();
    story.answer(story.known_there);
    const auto asked = sent<NeedDefinition>(story.tell_routes(nodes));
    REQUIRE(asked.size() == 1);
    CHECK_FALSE(asked[0].compact);
  }
  SUBCASE("another one") {
    story.tell_routes(story.members());
    Definition forged = story.known_there;
    forged.start.signature.bytes[5] ^= 1;
    const auto asked = sent<NeedDefinition>(story.answer(forged));
    REQUIRE(asked.size() == 1);
    CHECK_FALSE(asked[0].compact);
  }
  CHECK_FALSE(story.is_known());
  story.answer(sent<Definition>(story.ask(false)).at(0));
  CHECK(story.is_known());
  CHECK(story.other.handed_out.size() == 1);
}

TEST_CASE("a compact start that nothing waits for, that is none, or that comes again is refused or kept once") {
  Compact story;
  const auto refused = [&](const Definition& body) {
    const Outbox effects = story.answer(body);
    return effects.journal.empty() && targets<RouteListRequest>(effects).empty() && targets<NeedDefinition>(effects).empty();
  };
  Definition broken = story.known_there;
  broken.compact.bytes.resize(broken.compact.bytes.size() / 2);
  CHECK(refused(broken));
  for (int i = 0; i < 3; ++i) story.answer(story.known_there);
  CHECK(story.tell_routes(story.members()).journal.size() == 1);
  CHECK(story.is_known());
  CHECK(refused(story.known_there));
}
