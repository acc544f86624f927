// How runs become known, how many, and to whom they are shown.
#include <doctest/doctest.h>

#include <functional>

#include "common/scenario/run_id.hpp"
#include "common/scenario/run_start.hpp"
#include "services/scheduler/test/fleet.hpp"

using namespace trb;
using namespace trb::scheduler::test;

TEST_CASE("a baton for an unknown run waits for its definition, a short while and not too many of them") {
  Fleet fleet;
  add_demonstration(fleet);
  Baton baton;
  for (int i = 0; i < 64; ++i) {
    baton.run = std::string(30, 'b') + std::to_string(i + 10);
    const Outbox out = fleet.tell("ur3", "cloud", MessageType::command, baton);
    CHECK(sent<NeedDefinition>(out).size() == 1);
    CHECK(sent<NeedDefinition>(fleet.tell("ur3", "cloud", MessageType::command, baton)).size() == 1);
  }
  baton.run = std::string(32, 'c');
  CHECK(nack_of(fleet.tell("ur3", "cloud", MessageType::command, baton)) == "queue_full");
  fleet.pass(seconds(11));
  CHECK(fleet.counted["refused.baton.unknown_run"] == 64);
  CHECK(sent<NeedDefinition>(fleet.tell("ur3", "cloud", MessageType::command, baton)).size() == 1);
}

TEST_CASE("a definition is taken only from whom it was asked, and only if it is good") {
  Fleet fleet;
  add_demonstration(fleet);
  const SignedRecord start = fleet.make_start(chain({"ridgeback", "ur3"}), "cloud", seconds(3600), kRun);
  const Definition definition{start};
  CHECK(fleet.tell("ur3", "cloud", MessageType::information, definition, 1).journal.empty());
  Baton baton;
  baton.run = kRun;
  fleet.tell("ur3", "cloud", MessageType::command, baton);
  CHECK(fleet.tell("ur3", "drone", MessageType::information, definition, 1).journal.empty());
  Definition changed = definition;
  changed.start.signature.bytes[5] ^= 1;
  const Outbox out = fleet.tell("ur3", "cloud", MessageType::information, changed, 1);
  CHECK(out.journal.empty());
  CHECK(nack_of(out) == "bad_signature");
  CHECK(fleet.tell("ur3", "cloud", MessageType::information, definition, 1).journal.empty());
}

TEST_CASE("a start is taken only from its submitter, a member with a certificate of this fleet") {
  Fleet fleet;
  add_demonstration(fleet);
  Fleet foreign;
  foreign.add("ur3", Role::robot);
  const auto refused = [&](const std::function<void(RunStart&)>& change, const std::string& signer = "cloud") {
    RunStart start =
        build_run_start(chain({"ur3"}), fleet.members(), "cloud", fleet.now().utc, fleet.now().utc + seconds(60), kRun);
    change(start);
    const SignedRecord record = fleet.sign(signer, kSignedRunStart, encode(start));
    const Outbox out = fleet.tell("cloud", "cloud", MessageType::command, RunSubmit{record});
    CHECK(out.journal.empty());
    return nack_of(out);
  };
  CHECK(refused([](RunStart&) {}, "ur3") == "source_mismatch");
  CHECK(refused([](RunStart& is) { is.submitter = "ur3"; }) == "source_mismatch");
  CHECK(refused([](RunStart& is) { std::erase_if(is.members, [](const Member& one) { return one.id == "cloud"; }); }) ==
        "not_permitted");
  CHECK(refused([](RunStart& is) { is.digest.bytes[0] ^= 1; }) == "conflict");
  CHECK(refused([](RunStart& is) { is.members[1].certificate = is.members[2].certificate; }) == "source_mismatch");
  CHECK(refused([&](RunStart& is) { is.members.back() = foreign.member("ur3"); }) == "foreign_fleet");
  CHECK(refused([](RunStart& is) {
          is.scenario.tasks[0].robot.clear();
          is.digest.bytes = digest(encode(is.scenario));
          is.first.robots[0] = "cloud";
        }) == "bad_value");
}

TEST_CASE("a member that learns a run's id gives nobody a run of its own by it, whoever hears of it first") {
  Fleet fleet;
  add_demonstration(fleet);
  const std::string run = make_run_id("cloud", "random!");
  Baton baton;
  baton.run = run;
  const auto define = [&](const std::string& by) {
    CHECK(sent<NeedDefinition>(fleet.tell("drone", by, MessageType::command, baton)).size() == 1);
    const Definition definition{fleet.make_start(chain({"drone"}), by, seconds(60), run)};
    return fleet.tell("drone", by, MessageType::information, definition, 1);
  };
  const Outbox stolen = define("ur3");
  CHECK(stolen.journal.empty());
  CHECK(nack_of(stolen) == "bad_value");
  CHECK_FALSE(define("cloud").journal.empty());
}

TEST_CASE("a submit is repeated without harm; another start under its id is a conflict") {
  Fleet fleet;
  add_demonstration(fleet);
  const SignedRecord start = fleet.make_start(chain({"ur3"}), "cloud", seconds(60), kRun);
  CHECK(fleet.tell("cloud", "cloud", MessageType::command, RunSubmit{start}).journal.size() == 2);  // and the time
  const Outbox again = fleet.tell("cloud", "cloud", MessageType::command, RunSubmit{start});
  CHECK(again.journal.empty());
  CHECK(sent<RunAccepted>(again).size() == 1);
  const SignedRecord other = fleet.make_start(chain({"drone"}), "cloud", seconds(60), kRun);
  CHECK(nack_of(fleet.tell("cloud", "cloud", MessageType::command, RunSubmit{other})) == "conflict");
  CHECK(nack_of(fleet.tell("cloud", "ur3", MessageType::command, RunSubmit{start})) == "not_permitted");
}

TEST_CASE("no more than 512 runs are open, and no submitter has all of them") {
  Fleet fleet;
  for (const char* robot : {"drone", "ridgeback", "ur3"}) fleet.add(robot, Role::robot);
  int count = 0;
  const auto submit = [&](const std::string& submitter) {
    const std::string run = std::string(29, 'd') + std::to_string(100 + count);
    const SignedRecord start = fleet.make_start(chain({"ridgeback"}), submitter, seconds(60), run);
    const Outbox out = fleet.tell("ur3", "ur3", MessageType::command, RunSubmit{start});
    const bool accepted = !sent<RunAccepted>(out).empty();
    count += accepted ? 1 : 0;
    if (!accepted) CHECK(nack_of(out) == "queue_full");
    return accepted;
  };
  const auto all_of = [&](const std::string& submitter) {
    int accepted = 0;
    while (submit(submitter)) ++accepted;
    return accepted;
  };
  CHECK(all_of("ur3") == 480);
  CHECK(all_of("ridgeback") == 30);
  CHECK(all_of("drone") == 2);
  CHECK(count == 512);
}

TEST_CASE("a node whose disk is full takes no new run, and goes on with those that it has") {
  Fleet fleet;
  for (const char* robot : {"ridgeback", "ur3"}) fleet.add(robot, Role::robot);
  const auto submit = [&](char letter) {
    const SignedRecord start = fleet.make_start(chain({"ur3"}), "ur3", seconds(60), std::string(32, letter));
    return fleet.tell("ur3", "ur3", MessageType::command, RunSubmit{start});
  };
  REQUIRE(sent<RunAccepted>(submit('a')).size() == 1);
  fleet["ur3"].archive->set_room(fail(Errc::queue_full, "the disk of /n/state is full", "make room"));
  const Outbox refused = submit('b');
  CHECK(refused.journal.empty());
  REQUIRE(sent<Nack>(refused).size() == 1);
  CHECK(sent<Nack>(refused)[0].what == "the disk of /n/state is full");
  CHECK(sent<RunAccepted>(submit('a')).size() == 1);  // known, so it is only confirmed
  fleet["ur3"].archive->set_room(Done{});
  CHECK(sent<RunAccepted>(submit('b')).size() == 1);
}

TEST_CASE("runs are asked for by the beginning of their id, newest first") {
  Fleet fleet;
  add_demonstration(fleet);
  for (const char digit : {'1', '2'}) {
    const std::string run = "ab" + std::string(30, digit);
    const SignedRecord start = fleet.make_start(chain({"ur3"}), "cloud", seconds(600), run);
    fleet.tell("cloud", "cloud", MessageType::command, RunSubmit{start});
    fleet.pass(seconds(1));
  }
  CHECK(fleet.view("cloud", "").run.substr(0, 3) == "ab2");
  CHECK(fleet.view("cloud", "ab1").run.substr(0, 3) == "ab1");
  CHECK(nack_of(fleet.tell("cloud", "ur3", MessageType::request, RunQuery{"ab"})) == "bad_value");
  CHECK(nack_of(fleet.tell("cloud", "ur3", MessageType::request, RunQuery{"c"})) == "unknown_run");
  const auto tables = sent<RunTable>(fleet.tell("cloud", "ur3", MessageType::request, RunListRequest{}));
  REQUIRE(tables.size() == 1);
  REQUIRE(tables[0].runs.size() == 2);
  CHECK(tables[0].runs[0].run.substr(0, 3) == "ab2");
  CHECK(tables[0].runs[0].tasks == 1);
}

TEST_CASE("a subtype that is no scheduler's is refused") {
  Fleet fleet;
  fleet.add("ur3", Role::robot);
  CHECK(nack_of(fleet.tell("ur3", "cloud", MessageType::command, Stop{"now"})) == "unknown_subtype");
  CHECK(nack_of(fleet.tell("ur3", "cloud", MessageType::request, Opaque{"song", "la"})) == "unknown_subtype");
  const Outbox out = fleet.tell("ur3", "cloud", MessageType::information, Opaque{"song", "la"});
  CHECK(nack_of(out) == "unknown_subtype");
  CHECK(out.counts == std::vector<std::string>{"refused.opaque.unknown_subtype"});
  CHECK(fleet.tell("ur3", "cloud", MessageType::information, Stop{"now"}).sends.empty());
}
