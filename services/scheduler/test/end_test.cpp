// How runs end before they are finished: abort and expiry.
#include <doctest/doctest.h>

#include <algorithm>

#include "services/scheduler/test/fleet.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

struct DemoFleet : Fleet {
  DemoFleet() { add_demonstration(*this); }
};

void submit_nine(Fleet& fleet, const std::string& node, Duration life = seconds(3600)) {
  fleet.ask(node, MessageType::command, RunSubmit{fleet.make_start(nine_tasks(), node, life, kRun)});
}

void abort(Fleet& fleet, const std::string& node) {
  fleet.ask(node, MessageType::command, RunAbort{fleet.sign_order(node, kRun)});
}

std::string last_nack(const Fleet& fleet) {
  const auto* nack = fleet.answers.empty() ? nullptr : get_if<Nack>(&fleet.answers.back());
  return nack == nullptr ? "" : nack->code;
}

bool has_begun(Fleet& fleet, const std::string& robot) {
  return !fleet[robot].adapter.begun.empty();
}

bool all_say(Fleet& fleet, RunState state) {
  const auto members = fleet.members();
  return std::ranges::all_of(members, [&](const Member& member) { return fleet.view(member.id, kRun).state == state; });
}

/// It is over on that node, and kept so.
std::optional<RunState> archived(Fleet& fleet, const std::string& node) {
  const auto over = fleet[node].archive->over(kRun);
  return over ? std::optional(over->state) : std::nullopt;
}

}  // namespace

TEST_CASE("an abort stops what runs, starts nothing more and is done when every member has confirmed") {
  DemoFleet fleet;
  submit_nine(fleet, "cloud");
  REQUIRE(fleet.until([&] { return has_begun(fleet, "ur3"); }));
  fleet["drone"].cut = true;  // has never heard of the run
  abort(fleet, "cloud");
  REQUIRE(holds_alternative<Ack>(fleet.answers.back()));
  CHECK(get<Ack>(fleet.answers.back()).state == "accepted");
  CHECK(fleet.view("cloud", kRun).state == RunState::aborting);
  fleet.pass(seconds(10));
  CHECK(fleet.view("cloud", kRun).state == RunState::aborting);
  CHECK(fleet.view("cloud", kRun).waits_for == "the confirmation of 'drone'");
  CHECK(fleet.view("ur3", kRun).waits_for == "the confirmation of 'drone'");
  CHECK(fleet.view("cloud", kRun).tasks[2].reason == "cancelled");
  fleet["drone"].cut = false;
  REQUIRE(fleet.until([&] { return all_say(fleet, RunState::aborted); }, seconds(5)));
  fleet.pass(seconds(60));
  CHECK_FALSE(has_begun(fleet, "pioneer"));
}

TEST_CASE("a robot that learns of a run only to abort it starts nothing of it") {
  DemoFleet fleet;
  fleet["ridgeback"].cut = true;
  submit_nine(fleet, "cloud");
  fleet.pass(seconds(1));
  abort(fleet, "cloud");
  fleet["ridgeback"].cut = false;
  REQUIRE(fleet.until([&] { return all_say(fleet, RunState::aborted); }, seconds(5)));
  fleet.pass(seconds(30));
  CHECK_FALSE(has_begun(fleet, "ridgeback"));
}

TEST_CASE("an abort survives the death of whoever ordered it, in bad weather") {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    CAPTURE(seed);
    Fleet fleet(seed);
    add_demonstration(fleet);
    fleet.weather = {300, 200, 100, seconds(0.8)};
    submit_nine(fleet, "ridgeback");
    REQUIRE(fleet.until([&] { return has_begun(fleet, "conveyor"); }));
    fleet["ridgeback"].crash.at = fleet["ridgeback"].crash.commits + seed % 4 + 1;
    abort(fleet, "ridgeback");
    REQUIRE(
        fleet.until([&] { return fleet["ridgeback"].up && fleet.view("ridgeback", kRun).state == RunState::aborted; },
                    seconds(60)));
    CHECK(fleet.until([&] { return all_say(fleet, RunState::aborted); }, seconds(60)));
  }
}

TEST_CASE("an abort while the mode-adapter starts anew is confirmed, and the task is interrupted") {
  DemoFleet fleet;
  submit_nine(fleet, "cloud");
  REQUIRE(fleet.until([&] { return has_begun(fleet, "ridgeback"); }));
  fleet["ridgeback"].adapter.restart();
  abort(fleet, "cloud");
  REQUIRE(fleet.until([&] { return fleet.view("cloud", kRun).state == RunState::aborted; }, seconds(10)));
  CHECK(fleet.view("cloud", kRun).tasks[0].outcome == TaskOutcome::interrupted);
}

TEST_CASE("an attempt that was commanded in vain is not commanded again after an abort") {
  DemoFleet fleet;
  fleet["ridgeback"].crash.at = 1;  // definition and start record are one step; the command is lost with it
  submit_nine(fleet, "cloud");
  REQUIRE(fleet.until([&] { return !fleet["ridgeback"].up; }));
  fleet.weather.local_loss = 1000;  // the questions to the mode-adapter come after the abort
  abort(fleet, "cloud");
  fleet.pass(seconds(5));
  CHECK(fleet.view("ridgeback", kRun).state == RunState::aborting);
  fleet.weather.local_loss = 0;
  REQUIRE(fleet.until([&] { return fleet.view("cloud", kRun).state == RunState::aborted; }, seconds(10)));
  CHECK_FALSE(has_begun(fleet, "ridgeback"));
  CHECK(fleet.view("ridgeback", kRun).tasks[0].outcome == TaskOutcome::retriable);
}

TEST_CASE("only a known, unfinished run can be aborted, and only by a member's own word") {
  DemoFleet fleet;
  abort(fleet, "cloud");
  CHECK(last_nack(fleet) == "unknown_run");
  submit_nine(fleet, "cloud");
  const SignedRecord wrong_run = fleet.sign_order("cloud", std::string(32, 'c'));
  SignedRecord wrong_signer = fleet.sign_order("ur3", kRun);
  wrong_signer.signer = "cloud";
  fleet.ask("cloud", MessageType::command, RunAbort{wrong_run});
  CHECK(last_nack(fleet) == "unknown_run");
  fleet.ask("cloud", MessageType::command, RunAbort{wrong_signer});
  CHECK(last_nack(fleet) == "bad_signature");
  REQUIRE(fleet.until([&] { return fleet.view("cloud", kRun).state == RunState::finished; }));
  abort(fleet, "cloud");
  CHECK(last_nack(fleet) == "conflict");
}

TEST_CASE("an expired run ends what runs, starts nothing more, and is kept with all its results") {
  DemoFleet fleet;
  submit_nine(fleet, "cloud", seconds(2.5));
  fleet.pass(seconds(10));
  CHECK(last_nack(fleet).empty());
  CHECK_FALSE(has_begun(fleet, "pioneer"));
  for (const char* node : {"cloud", "conveyor", "ridgeback", "ur3"}) CHECK(archived(fleet, node) == RunState::expired);
  submit_nine(fleet, "cloud", seconds(3600));
  CHECK(last_nack(fleet) == "expired");
  fleet.ask("cloud", MessageType::request, RunQuery{kRun});
  const auto& view = get<RunView>(fleet.answers.back());
  CHECK(view.state == RunState::expired);
  CHECK(view.over >= view.expires);
  CHECK(view.tasks[0].state == TaskState::finished);
  CHECK(view.tasks[0].data == R"({"done":true})");
  CHECK(fleet["cloud"].archive->records().at(0).results.size() == 2);
  fleet.stop("cloud");
  fleet.start("cloud");
  abort(fleet, "cloud");
  CHECK(last_nack(fleet) == "expired");
}

TEST_CASE("what is owed of an expired run is owed a day longer, then given up") {
  DemoFleet fleet;
  submit_nine(fleet, "ridgeback", seconds(20));
  fleet["cloud"].cut = true;
  fleet.pass(seconds(3600));
  CHECK_FALSE(archived(fleet, "ur3"));
  fleet["cloud"].cut = false;
  fleet.pass(seconds(10));
  // The cloud never knew the run and it is too late to learn of it; the debt lapses by that refusal.
  CHECK(archived(fleet, "ur3") == RunState::expired);
}

TEST_CASE("a run that has expired on arrival is refused") {
  DemoFleet fleet;
  const SignedRecord start = fleet.make_start(nine_tasks(), "cloud", seconds(1), kRun);
  fleet.pass(seconds(2));
  fleet.ask("cloud", MessageType::command, RunSubmit{start});
  CHECK(last_nack(fleet) == "expired");
}

TEST_CASE("a clock that is 25 h ahead for 3 s ends no run, on no node") {
  DemoFleet fleet;
  fleet["ur3"].adapter.ending = TaskOutcome::failed;
  submit_nine(fleet, "cloud", seconds(24 * 3600));
  REQUIRE(fleet.until([&] { return fleet.view("cloud", kRun).state == RunState::paused; }));
  for (const char* node : {"cloud", "ridgeback"}) {
    fleet[node].clock.set({.ahead_s = 25 * 3600});
    for (int i = 0; i < 3; ++i) {
      fleet.pass(seconds(1));
      CHECK(fleet.view(node, kRun).left_s > 23 * 3600);
    }
    fleet[node].clock.set({});
  }
  fleet.pass(seconds(3600));
  CHECK(fleet.view("cloud", kRun).state == RunState::paused);
  // Nor does a node that starts with such a clock.
  fleet.stop("cloud");
  fleet["cloud"].clock.set({.ahead_s = 25 * 3600});
  fleet.start("cloud");
  fleet.pass(seconds(60));
  CHECK(fleet.view("cloud", kRun).state == RunState::paused);
}

TEST_CASE("a run that waits for a word when its time is over is kept with its results, and can be looked at") {
  DemoFleet fleet;
  fleet["ur3"].adapter.ending = TaskOutcome::failed;
  submit_nine(fleet, "cloud", seconds(24 * 3600));
  REQUIRE(fleet.until([&] { return fleet.view("cloud", kRun).state == RunState::paused; }));
  fleet.pass(seconds(24 * 3600));
  CHECK(archived(fleet, "cloud") == RunState::expired);
  const RunView view = fleet.view("cloud", kRun);
  CHECK(view.state == RunState::expired);
  CHECK(view.tasks[2].reason == "the gripper is stuck");
  CHECK(fleet["cloud"].archive->records().at(0).results.size() == 3);
  fleet.pass(seconds(48 * 3600));
  CHECK(fleet.view("cloud", kRun).tasks[2].reason == "the gripper is stuck");
}

TEST_CASE("a run that has FINISHED goes to every member's archive within minutes, whoever was away") {
  Fleet fleet(3);
  add_demonstration(fleet);
  submit_nine(fleet, "cloud");
  REQUIRE(fleet.until([&] { return fleet.view("cloud", kRun).tasks[7].state == TaskState::finished; }));
  fleet["conveyor"].cut = true;
  fleet.stop("pioneer");
  REQUIRE(fleet.until([&] { return archived(fleet, "cloud") == RunState::finished; }, seconds(120)));
  CHECK(fleet.until([&] { return archived(fleet, "ur3") == RunState::finished; }, seconds(1)));
  CHECK_FALSE(archived(fleet, "conveyor"));
  fleet["conveyor"].cut = false;
  fleet.start("pioneer");
  CHECK(fleet.until(
      [&] {
        return archived(fleet, "conveyor") == RunState::finished && archived(fleet, "pioneer") == RunState::finished;
      },
      seconds(1300)));
  for (const Member& member : fleet.members()) {
    const auto& journal = fleet[member.id].journal;
    CHECK(std::ranges::none_of(journal,
                               [](const JournalRecord& record) { return holds_alternative<JournalResult>(record); }));
  }
}

TEST_CASE("only the judge's word ends a run, and none that is forged, of another run, or that says otherwise") {
  DemoFleet fleet;
  submit_nine(fleet, "cloud");
  REQUIRE(fleet.until([&] { return has_begun(fleet, "ridgeback"); }));
  const auto start = decode<RunStart>(get<JournalRun>(fleet["ridgeback"].journal[0]).start.payload.bytes);
  const auto told = [&](const std::string& by, const std::function<void(RunEnd&)>& change, bool forge = false) {
    RunEnd end{kRun, start->digest, by, RunState::finished, 0};
    change(end);
    SignedRecord record = fleet.sign(by, kSignedRunEnd, encode(end));
    if (forge) record.payload.bytes.back() ^= 1;
    fleet.hear("ridgeback", by, MessageType::information, RunOver{record});
    return fleet.view("ridgeback", kRun).state;
  };
  const auto nothing = [](RunEnd&) {};
  CHECK(told("ur3", nothing) == RunState::running);
  CHECK(told("cloud", nothing, true) == RunState::running);
  CHECK(told("cloud", [](RunEnd& end) { end.run = std::string(32, 'b'); }) == RunState::running);
  CHECK(told("cloud", [](RunEnd& end) { end.digest.bytes[0] ^= 1; }) == RunState::running);
  CHECK(told("cloud", [](RunEnd& end) { end.by = "ur3"; }) == RunState::running);
  CHECK(told("cloud", [](RunEnd& end) { end.state = RunState::aborted; }) == RunState::running);
  CHECK(told("cloud", nothing) == RunState::finished);
}

TEST_CASE("a day of runs fills nothing: only those that are open take a place") {
  DemoFleet fleet;
  const int runs = 540;
  for (int i = 0; i < runs; ++i) {
    char id[33];
    std::snprintf(id, sizeof id, "%032x", static_cast<unsigned>(i));
    fleet.ask("cloud", MessageType::command,
              RunSubmit{fleet.make_start(chain({"ur3", "drone"}), "cloud", seconds(24 * 3600), id)});
    REQUIRE(holds_alternative<RunAccepted>(fleet.answers.back()));
    fleet.pass(seconds(30));
  }
  fleet.pass(seconds(1300));
  for (const Member& member : fleet.members()) {
    CAPTURE(member.id);
    CHECK(fleet[member.id].archive->size() ==
          (member.id == "cloud" || member.id == "ur3" || member.id == "drone" ? runs : 0));
    CHECK(fleet[member.id].journal.size() <= 1);
  }
  fleet.ask("cloud", MessageType::request, RunListRequest{true, "", 500});
  const auto first = get<RunTable>(fleet.answers.back());
  CHECK(first.runs.size() == 500);
  CHECK(first.more);
  CHECK(first.open == 0);
  CHECK(first.open_max == 512);
  fleet.ask("cloud", MessageType::request, RunListRequest{true, first.runs.back().run, 500});
  CHECK(get<RunTable>(fleet.answers.back()).runs.size() == 40);
  CHECK_FALSE(get<RunTable>(fleet.answers.back()).more);
  fleet.ask("cloud", MessageType::request, RunListRequest{true, "", 0});
  CHECK(last_nack(fleet) == "bad_value");
}

TEST_CASE("a member that has no place for a run is named, and gets it when there is place") {
  DemoFleet fleet;
  fleet["ur3"].adapter.set(false, false);
  for (int i = 0; i < 512; ++i) {
    char id[33];
    std::snprintf(id, sizeof id, "%032x", static_cast<unsigned>(i));
    const char* submitter = i < 480 ? "cloud" : i < 510 ? "drone" : "pioneer";  // each has its share
    fleet.ask("cloud", MessageType::command, RunSubmit{fleet.make_start(chain({"ur3"}), submitter, seconds(100), id)});
  }
  submit_nine(fleet, "ridgeback");
  fleet.pass(seconds(60));
  CHECK(fleet.view("ridgeback", kRun).waits_for.starts_with("'cloud' to take the run: no place for run"));
  fleet.pass(seconds(60));
  CHECK(fleet.until([&] { return fleet.view("cloud", kRun).run == kRun; }, seconds(10)));
  CHECK(fleet.view("ridgeback", kRun).waits_for.empty());
}
