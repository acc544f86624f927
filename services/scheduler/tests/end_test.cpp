// How runs end before they are finished: abort and expiry.
#include <doctest/doctest.h>

#include <algorithm>

#include "services/scheduler/tests/fleet.hpp"

using namespace trb;
using namespace trb::scheduler::test;

namespace {

const std::string kRun(32, 'a');

void submit(Fleet& fleet, const std::string& node, Duration life = seconds(3600)) {
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
  Fleet fleet;
  add_demonstration(fleet);
  submit(fleet, "cloud");
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
  Fleet fleet;
  add_demonstration(fleet);
  fleet["ridgeback"].cut = true;
  submit(fleet, "cloud");
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
    submit(fleet, "ridgeback");
    REQUIRE(fleet.until([&] { return has_begun(fleet, "conveyor"); }));
    fleet["ridgeback"].crash_at = fleet["ridgeback"].commits + seed % 4 + 1;
    abort(fleet, "ridgeback");
    REQUIRE(
        fleet.until([&] { return fleet["ridgeback"].up && fleet.view("ridgeback", kRun).state == RunState::aborted; },
                    seconds(60)));
    CHECK(fleet.until([&] { return all_say(fleet, RunState::aborted); }, seconds(60)));
  }
}

TEST_CASE("an abort while the mode-adapter starts anew is confirmed, and the task is interrupted") {
  Fleet fleet;
  add_demonstration(fleet);
  submit(fleet, "cloud");
  REQUIRE(fleet.until([&] { return has_begun(fleet, "ridgeback"); }));
  fleet["ridgeback"].adapter.restart();
  abort(fleet, "cloud");
  REQUIRE(fleet.until([&] { return fleet.view("cloud", kRun).state == RunState::aborted; }, seconds(10)));
  CHECK(fleet.view("cloud", kRun).tasks[0].outcome == TaskOutcome::interrupted);
}

TEST_CASE("an attempt that was commanded in vain is not commanded again after an abort") {
  Fleet fleet;
  add_demonstration(fleet);
  fleet["ridgeback"].crash_at = 1;  // definition and start record are one step; the command is lost with it
  submit(fleet, "cloud");
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
  Fleet fleet;
  add_demonstration(fleet);
  abort(fleet, "cloud");
  CHECK(last_nack(fleet) == "unknown_run");
  submit(fleet, "cloud");
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
  Fleet fleet;
  add_demonstration(fleet);
  submit(fleet, "cloud", seconds(2.5));
  fleet.pass(seconds(10));
  CHECK(last_nack(fleet).empty());
  CHECK_FALSE(has_begun(fleet, "pioneer"));
  for (const char* node : {"cloud", "conveyor", "ridgeback", "ur3"}) CHECK(archived(fleet, node) == RunState::expired);
  submit(fleet, "cloud", seconds(3600));
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
  Fleet fleet;
  add_demonstration(fleet);
  submit(fleet, "ridgeback", seconds(20));
  fleet["cloud"].cut = true;
  fleet.pass(seconds(3600));
  CHECK_FALSE(archived(fleet, "ur3"));
  fleet["cloud"].cut = false;
  fleet.pass(seconds(10));
  // The cloud never knew the run and it is too late to learn of it; the debt lapses by that refusal.
  CHECK(archived(fleet, "ur3") == RunState::expired);
}

TEST_CASE("a run that has expired on arrival is refused") {
  Fleet fleet;
  add_demonstration(fleet);
  const SignedRecord start = fleet.make_start(nine_tasks(), "cloud", seconds(1), kRun);
  fleet.pass(seconds(2));
  fleet.ask("cloud", MessageType::command, RunSubmit{start});
  CHECK(last_nack(fleet) == "expired");
}
