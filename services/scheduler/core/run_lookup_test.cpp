#include "services/scheduler/core/run_lookup.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

using Names = std::vector<std::string>;
const std::string kUnknown(32, 'c');

Inbound baton_of(const KnownRun& known, const std::string& from, const std::string& run, std::uint64_t reply_to = 0) {
  Baton baton;
  baton.run = run;
  return known.from(from, MessageType::command, baton, reply_to);
}

}  // namespace

TEST_CASE("a run is found for its members alone") {
  KnownRun known(chain({"ur3"}));
  known.signers.add("stranger", Role::robot);
  Outbox out;
  CHECK(known.lookup.find(kKnownRun, baton_of(known, "drone", kKnownRun), known.step(out)) == &known.run());
  CHECK(known.lookup.find(kKnownRun, baton_of(known, "stranger", kKnownRun), known.step(out)) == nullptr);
  CHECK(known.lookup.find(kUnknown, baton_of(known, "drone", kUnknown), known.step(out)) == nullptr);
  CHECK(nacks(out) == Names{"not_permitted", "unknown_run"});
}

TEST_CASE("what a peer says of an unknown run waits for the definition, 10 s at most; an answer does not") {
  KnownRun known(chain({"ur3"}));
  Outbox out;
  CHECK(known.lookup.find_or_defer(kUnknown, {}, baton_of(known, "drone", kUnknown), known.step(out)) == nullptr);
  CHECK(targets<NeedDefinition>(out) == Names{"drone"});
  CHECK(known.lookup.awaits_definition(kUnknown, "drone"));
  CHECK_FALSE(known.lookup.awaits_definition(kUnknown, "pioneer"));
  known.lookup.find_or_defer(kUnknown, {}, baton_of(known, "pioneer", kUnknown, 5), known.step(out));
  CHECK(targets<NeedDefinition>(out) == Names{"drone"});
  known.pass(10);
  Outbox late;
  known.lookup.refuse_late(known.step(late));
  CHECK(nacks(late) == Names{"unknown_run"});
}

TEST_CASE("a member that speaks of many unknown runs takes nobody's place: its newest message gives way") {
  KnownRun known(chain({"ur3"}));
  const auto unknown = [](std::size_t i) { return std::string(29, 'c') + std::to_string(100 + i); };
  Outbox out;
  const auto hear = [&](const std::string& from, std::size_t i) {
    out.clear();
    known.lookup.find_or_defer(unknown(i), {}, baton_of(known, from, unknown(i)), known.step(out));
  };
  constexpr std::size_t kPlaces = DeferredMessages::kMax;
  for (std::size_t i = 0; i < kPlaces; ++i) hear("drone", i);
  CHECK(nacks(out).empty());
  hear("drone", kPlaces);
  CHECK(nacks(out) == Names{"queue_full"});
  CHECK(targets<NeedDefinition>(out).empty());
  hear("pioneer", kPlaces);
  CHECK(nacks(out) == Names{"queue_full"});
  CHECK(targets<Nack>(out) == Names{"drone"});
  CHECK(targets<NeedDefinition>(out) == Names{"pioneer"});
  CHECK(known.lookup.awaits_definition(unknown(kPlaces), "pioneer"));
  CHECK(known.lookup.awaits_definition(unknown(kPlaces - 2), "drone"));
  CHECK_FALSE(known.lookup.awaits_definition(unknown(kPlaces - 1), "drone"));
}

TEST_CASE("what is of a later epoch is deferred, and its sender asked for the decisions; not while it is handed out") {
  KnownRun known(chain({"ur3"}));
  Outbox out;
  const Inbound later = baton_of(known, "drone", kKnownRun);
  CHECK_FALSE(known.lookup.defer_for_decisions(known.run(), 1, later, known.step(out)));
  CHECK(known.lookup.defer_for_decisions(known.run(), 2, later, known.step(out)));
  CHECK(targets<NeedDefinition>(out) == Names{"drone"});
  Outbox again;
  const auto dispatch = [&](const Inbound& message, Step step) {
    CHECK(known.lookup.defer_for_decisions(known.run(), 2, message, step));
  };
  known.lookup.hand_out(kKnownRun, dispatch, known.step(again));
  CHECK(targets<NeedDefinition>(again).empty());
  CHECK(nacks(again) == Names{"conflict"});
}

TEST_CASE("of a run in the archive a peer is told how it ended") {
  KnownRun known(chain({"ur3"}));
  JournalArchive record;
  record.view.run = kUnknown;
  record.view.state = RunState::finished;
  record.end = known.end();
  record.until = known.now.utc.ns + 1'000'000'000;
  known.archive.put(record);
  Outbox out;
  CHECK(known.lookup.find_or_defer(kUnknown, {}, baton_of(known, "drone", kUnknown), known.step(out)) == nullptr);
  CHECK(targets<RunOver>(out) == Names{"drone"});
  CHECK(nacks(out) == Names{"expired"});
}

TEST_CASE("of an aborted run in the archive a peer is told the order, once for what it says and never for the answer") {
  KnownRun known(chain({"ur3"}));
  JournalArchive record;
  record.view.run = kUnknown;
  record.view.state = RunState::aborted;
  record.orders = {known.pause(1, true), known.abort()};
  record.until = known.now.utc.ns + 1'000'000'000;
  known.archive.put(record);
  const auto said = [&](const std::string& from, Body body) {
    Outbox out;
    known.lookup.find(kUnknown, known.from(from, MessageType::information, std::move(body)), known.step(out));
    return out;
  };
  const Outbox out = said("drone", TaskProgress{{kUnknown, "task-0", 1, 1}, "drone", TaskState::running, ""});
  REQUIRE(targets<RunAbort>(out) == Names{"drone"});
  CHECK(sent<RunAbort>(out).at(0).order == known.abort());
  CHECK(targets<RunAbort>(said("drone", NeedEnd{kUnknown})) == Names{"drone"});
  CHECK(targets<RunAbort>(said("drone", AbortConfirmed{kUnknown})).empty());
  CHECK(targets<RunAbort>(said("drone", NeedDefinition{kUnknown, {}})).empty());
  CHECK(targets<RunAbort>(said("ur3", NeedEnd{kUnknown})).empty());
}
