// What is forged, late, repeated or meant for others: each has its effect, and none harms.
#include <doctest/doctest.h>

#include <functional>

#include "services/scheduler/test/fleet.hpp"
#include "services/scheduler/test/forged.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

/// A fleet in which ur3 and the cloud know a run of two tasks: ridgeback's, then ur3's.
struct Known {
  Known() {
    add_demonstration(fleet);
    start = fleet.make_start(chain({"ridgeback", "ur3"}), "cloud", seconds(3600), kRun);
    fleet.stop("ridgeback");
    fleet.ask("cloud", MessageType::command, RunSubmit{start});
    baton.run = kRun;
    baton.digest = digest_of_run();
    baton.final_tasks.bytes = "\x01";
    baton.tasks = {1};
    fleet.tell("ur3", "cloud", MessageType::command, with_results({}));
    fleet.tell("ur3", "cloud", MessageType::information, Definition{start}, 99);
  }

  [[nodiscard]] Blob digest_of_run() const { return decode<RunStart>(start.payload.bytes)->digest; }

  [[nodiscard]] Baton with_results(std::vector<SignedRecord> results) const {
    Baton out = baton;
    out.results = std::move(results);
    return out;
  }

  TaskResult result() const {
    TaskResult out;
    out.key = {kRun, "task-0", 1, 1};
    out.digest = digest_of_run();
    out.robot = "ridgeback";
    out.outcome = TaskOutcome::finished;
    return out;
  }

  SignedRecord signed_by(const std::string& who, const std::function<void(TaskResult&)>& change = {}) const {
    TaskResult out = result();
    if (change) change(out);
    return fleet.sign(who, kSignedResult, encode(out));
  }

  Outbox pass(SignedRecord record) {
    return fleet.tell("ur3", "ridgeback", MessageType::command, with_results({std::move(record)}));
  }

  Fleet fleet;
  SignedRecord start;
  Baton baton;
};

}  // namespace

TEST_CASE("a baton with a good result is journaled, acknowledged, and starts the task in the same step") {
  Known known;
  known.fleet.pass(seconds(1));
  const Outbox out = known.pass(known.signed_by("ridgeback"));
  REQUIRE(sent<BatonJournaled>(out).size() == 1);
  CHECK(sent<BatonJournaled>(out)[0].tasks == std::vector<std::uint16_t>{1});
  REQUIRE(out.journal.size() == 2);
  CHECK(std::any_cast<JournalResult>(&out.journal[0].record) != nullptr);
  CHECK(std::any_cast<JournalStart>(&out.journal[1].record) != nullptr);
  REQUIRE(sent<Execute>(out).size() == 1);
  CHECK(sent<Execute>(out)[0].instance == 100);
  // Repeated: acknowledged again, and nothing else.
  const Outbox again = known.pass(known.signed_by("ridgeback"));
  CHECK(sent<BatonJournaled>(again).size() == 1);
  CHECK(again.journal.empty());
  CHECK(sent<Execute>(again).empty());
}

TEST_CASE("a forged result is refused and leaves no trace") {
  Known known;
  const auto refused = [&](const SignedRecord& record) {
    const Outbox out = known.pass(record);
    CHECK(out.journal.empty());
    CHECK(sent<BatonJournaled>(out).empty());
    return nack_of(out);
  };
  SignedRecord renamed = known.signed_by("drone");
  renamed.signer = "ridgeback";
  CHECK(refused(renamed) == "bad_signature");
  check_forged(known.signed_by("ridgeback"), kSignedRunAbort, refused);
  CHECK(refused(known.signed_by("drone")) == "not_permitted");
  CHECK(refused(known.signed_by("drone", [](TaskResult& is) { is.robot = "drone"; })) == "not_permitted");
  CHECK(refused(known.signed_by("cloud")) == "not_permitted");
  CHECK(refused(known.signed_by("ridgeback", [](TaskResult& is) { is.digest.bytes[0] ^= 1; })) == "conflict");
  CHECK(refused(known.signed_by("ridgeback", [](TaskResult& is) { is.key.run[0] = 'b'; })) == "conflict");
  CHECK(refused(known.signed_by("ridgeback", [](TaskResult& is) { is.epoch = 2; })) == "conflict");
  CHECK(refused(known.signed_by("ridgeback", [](TaskResult& is) { is.key.task = "task-7"; })) == "bad_value");
  CHECK(refused(known.signed_by("ridgeback", [](TaskResult& is) { is.key.iteration = 2; })) == "bad_value");
  CHECK(refused(known.signed_by("ridgeback", [](TaskResult& is) { is.key.attempt = 0; })) == "bad_value");
  CHECK(refused(known.signed_by("ridgeback", [](TaskResult& is) { is.outcome = {}; })) == "bad_value");
}

TEST_CASE("a baton of another epoch, definition, task or giver is refused") {
  Known known;
  const auto refused = [&](const std::string& from, const std::function<void(Baton&)>& change) {
    Baton baton = known.with_results({});
    change(baton);
    return nack_of(known.fleet.tell("ur3", from, MessageType::command, baton));
  };
  CHECK(refused("ridgeback", [](Baton& is) { is.epoch = 0; }) == "conflict");
  CHECK(refused("ridgeback", [](Baton& is) { is.digest.bytes[0] ^= 1; }) == "conflict");
  CHECK(refused("ridgeback", [](Baton& is) { is.tasks = {0}; }) == "bad_value");
  CHECK(refused("ridgeback", [](Baton& is) { is.tasks = {2}; }) == "bad_value");
  CHECK(refused("ridgeback", [](Baton& is) { is.final_tasks.bytes = "\x04"; }) == "too_large");
  CHECK(refused("stranger", [](Baton&) {}) == "not_permitted");
}

TEST_CASE("two different FINISHED of one task pause the run") {
  Known known;
  known.fleet.tell("cloud", "ridgeback", MessageType::command, Results{kRun, {known.signed_by("ridgeback")}, {}});
  CHECK(known.fleet.view("cloud", kRun).state == RunState::running);
  const SignedRecord second = known.signed_by("ridgeback", [](TaskResult& is) { is.data = "again"; });
  const Outbox out = known.fleet.tell("cloud", "ridgeback", MessageType::command, Results{kRun, {second}, {}});
  CHECK(sent<ResultsJournaled>(out).size() == 1);
  REQUIRE_FALSE(out.logs.empty());
  CHECK(out.logs.back().event == "double_execution");
  CHECK(known.fleet.view("cloud", kRun).state == RunState::paused);
  CHECK(known.fleet.view("cloud", kRun).waits_for == "'cloud' to hold it: a task was done twice");
  CHECK(known.fleet.view("cloud", kRun).tasks[0].twice);
  known.pass(known.signed_by("ridgeback"));
  CHECK(sent<Execute>(known.pass(second)).empty());
}

TEST_CASE("results are acknowledged by key; the bad ones among them are not") {
  Known known;
  const SignedRecord good = known.signed_by("ridgeback");
  const SignedRecord bad = known.signed_by("drone");
  const Outbox out = known.fleet.tell("cloud", "ridgeback", MessageType::command, Results{kRun, {good, bad}, {}});
  REQUIRE(sent<ResultsJournaled>(out).size() == 1);
  CHECK(sent<ResultsJournaled>(out)[0].keys.size() == 1);
  CHECK(nack_of(out) == "not_permitted");
}

TEST_CASE("a missing predecessor's result is asked for from whoever spoke of it") {
  Known known;
  const Outbox out = known.fleet.tell("ur3", "cloud", MessageType::command, known.with_results({}));
  REQUIRE(sent<BatonJournaled>(out).size() == 1);
  known.fleet.pass(seconds(3));  // the cloud holds nothing, so the question ends
  const int asked = known.fleet.carried["need_results"];
  CHECK(asked > 0);
  known.fleet.pass(seconds(60));
  CHECK(known.fleet.carried["need_results"] == asked);
  const Outbox answer =
      known.fleet.tell("ur3", "cloud", MessageType::information, Results{kRun, {known.signed_by("ridgeback")}, {}}, 7);
  CHECK(sent<Execute>(answer).size() == 1);
  CHECK(sent<ResultsJournaled>(answer).empty());
}

TEST_CASE("only the own node speaks for its robot") {
  Known known;
  known.pass(known.signed_by("ridgeback"));
  const AttemptKey key{kRun, "task-1", 1, 1};
  const Outcome outcome{key, 100, TaskOutcome::finished, "", "", 1};
  for (const Body& body : {Body{outcome}, Body{AdapterState{7, "ONLINE", false, false, {}}},
                           Body{ExecutionState{key, 7, "unknown"}}, Body{known.signed_by("ridgeback")}}) {
    const Outbox out = known.fleet.tell("ur3", "drone", MessageType::information, body);
    CHECK(out.journal.empty());
    CHECK(out.sends.empty());
    REQUIRE(out.counts.size() == 1);
    CHECK(out.counts[0].ends_with("not_permitted"));
  }
}

TEST_CASE("a refusal that passes is tried again, one that does not is the attempt's end") {
  Known known;
  known.fleet.pass(seconds(1));
  REQUIRE(sent<Execute>(known.pass(known.signed_by("ridgeback"))).size() == 1);
  const auto refuse = [&](const char* code) {
    return known.fleet.tell("ur3", "ur3", MessageType::information, Nack{code, "execute", "ur3", "no such skill", ""},
                            5);
  };
  CHECK(sent<AdapterStateRequest>(refuse("busy")).size() == 1);
  const Outbox state =
      known.fleet.tell("ur3", "ur3", MessageType::information, AdapterState{100, "ONLINE", false, false, {}});
  REQUIRE(sent<Execute>(state).size() == 1);
  const Outbox end = refuse("unknown_skill");
  REQUIRE(sent<SignRequest>(end).size() == 1);
  const auto result = decode<TaskResult>(sent<SignRequest>(end)[0].payload.bytes);
  CHECK(result->outcome == TaskOutcome::failed);
  CHECK(result->reason == "unknown_skill: no such skill");
}

TEST_CASE("late acknowledgements are counted, not believed") {
  Known known;
  for (const Body& body : {Body{BatonJournaled{kRun, 1, {1}}}, Body{AbortConfirmed{kRun}},
                           Body{ResultsJournaled{{{kRun, "task-1", 1, 1}}}}}) {
    const Outbox out = known.fleet.tell("cloud", "ur3", MessageType::information, body);
    CHECK(out.journal.empty());
    REQUIRE(out.counts.size() == 1);
    CHECK(out.counts[0].starts_with("late."));
  }
}

TEST_CASE("a run of a clock that is over a year ahead is refused: it would be known as over until its far end") {
  Known known;
  const auto refusals = [&](Duration ahead) {
    auto start = *decode<RunStart>(known.start.payload.bytes);
    start.run = std::string(32, 'd');
    start.created = (known.fleet.now().utc + ahead).ns;
    start.expires = start.created + Duration(seconds(3600)).count();
    return sent<Nack>(known.fleet.tell("cloud", "cloud", MessageType::command,
                                       RunSubmit{known.fleet.sign("cloud", kSignedRunStart, encode(start))}));
  };
  const auto refused = refusals(std::chrono::hours(24 * 367));
  REQUIRE(refused.size() == 1);
  CHECK(refused[0].code == "bad_value");
  CHECK(refused[0].hint.find("clocks") != std::string::npos);
  CHECK(refusals(std::chrono::hours(24 * 360)).empty());
}

TEST_CASE("a node that starts without a clock takes runs: one that is before its own certificate judges nobody's") {
  Known known;
  known.fleet.stop("drone");
  known.fleet["drone"].clock.set({.is_1970 = true});
  known.fleet.start("drone");
  const std::string run(32, 'd');
  known.fleet.ask("cloud", MessageType::command,
                  RunSubmit{known.fleet.make_start(chain({"drone"}), "cloud", seconds(3600), run)});
  CHECK(known.fleet.until([&] { return known.fleet.view("cloud", run).state == RunState::finished; }));
}
