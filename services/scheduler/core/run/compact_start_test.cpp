#include "services/scheduler/core/run/compact_start.hpp"

#include <doctest/doctest.h>

#include "common/base/deflate.hpp"
#include "common/scenario/run_start.hpp"
#include "proto/body.hpp"
#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

RouteTable table_of(const Signers& signers, const std::vector<std::string>& nodes) {
  RouteTable out;
  for (const std::string& node : nodes) {
    Route route;
    route.id = node;
    route.certificate = signers.certificate(node);
    out.routes.push_back(std::move(route));
  }
  return out;
}

}  // namespace

TEST_CASE("who knows the members makes the same bytes again of a start that travelled without their certificates") {
  Signers signers;
  const SignedRecord start = signers.start(chain({"ur3", "drone", "pioneer", "ur3", "drone", "pioneer"}));
  const auto compact = compact_start(start, false);
  REQUIRE(compact);
  CHECK(compact->bytes.size() * 3 < start.payload.bytes.size());
  const auto read = open_compact_start(*compact, false);
  REQUIRE(read);
  CHECK(read->run == kKnownRun);
  KnownCertificates known;
  CHECK_FALSE(known.complete(*read));
  std::vector<std::string> nodes;
  for (const Member& member : read->members) nodes.push_back(member.id);
  known.learn(table_of(signers, nodes));
  const auto complete = known.complete(*read);
  REQUIRE(complete);
  CHECK((encode(*complete) == start.payload.bytes));
  nodes.pop_back();
  known.learn(table_of(signers, nodes));
  CHECK_FALSE(known.complete(*read));
}

TEST_CASE(
    "an assignment that the tasks do not name travels; an electorate that does not follow keeps the start whole") {
  Signers signers;
  const RunStart read = *decode<RunStart>(signers.start(chain({"ur3", "drone"})).payload.bytes);
  const auto travels = [&](const RunStart& start) {
    const SignedRecord record = signers.sign("cloud", kSignedRunStart, encode(start));
    const auto compact = compact_start(record, false);
    if (!compact) return false;
    std::vector<std::string> nodes;
    for (const Member& member : start.members) nodes.push_back(member.id);
    KnownCertificates known;
    known.learn(table_of(signers, nodes));
    const auto complete = known.complete(*open_compact_start(*compact, false));
    REQUIRE(complete);
    CHECK((encode(*complete) == record.payload.bytes));
    return true;
  };
  CHECK(travels(read));
  RunStart bound = read;
  bound.scenario.tasks[1].robot.clear();
  CHECK(travels(build_run_start(bound.scenario, bound.members, "cloud", {10}, {20}, kKnownRun, {"ur3", "pioneer"}, 7)));
  RunStart other = read;
  other.electorate.pop_back();
  CHECK_FALSE(travels(other));
}

TEST_CASE("a start with a field that this version does not know travels whole") {
  Signers signers;
  SignedRecord start = signers.start(chain({"ur3"}));
  RunStart read = *decode<RunStart>(start.payload.bytes);
  Bytes longer = encode(read);
  // One more element at the array's tail, as a later version may write it.
  REQUIRE((static_cast<unsigned char>(longer[0]) & 0xf0U) == 0x90U);
  longer[0] = static_cast<char>(longer[0] + 1);
  start.payload.bytes = longer + '\x07';
  REQUIRE(decode<RunStart>(start.payload.bytes));
  CHECK_FALSE(compact_start(start, false));
  start.payload.bytes = "none";
  CHECK_FALSE(compact_start(start, false));
}

TEST_CASE("what is no start, or would be too large, is refused") {
  CHECK(open_compact_start({"x"}, false).error().code == Errc::malformed);
  CHECK_FALSE(open_compact_start({deflated("no start")}, false).ok());
  // NOLINTNEXTLINE(bugprone-string-constructor): it is to be large
  CHECK(open_compact_start({deflated(Bytes(10'000'000, 'a'))}, false).error().code == Errc::too_large);
  // Few bytes cost their reader little.
  CHECK(open_compact_start({deflated(Bytes(100'000, 'a'))}, false).error().code == Errc::too_large);
}

TEST_CASE("a start that says one thing a thousand times travels whole") {
  Signers signers;
  RunStart read = *decode<RunStart>(signers.start(chain({"ur3", "drone"})).payload.bytes);
  for (Task& task : read.scenario.tasks) task.data = std::string(60'000, 'x');
  read = build_run_start(read.scenario, read.members, "cloud", {10}, {20}, kKnownRun);
  CHECK_FALSE(compact_start(signers.sign("cloud", kSignedRunStart, encode(read)), false));
}

TEST_CASE("numbered tasks one behind the other travel in a few bytes each, and come back") {
  Signers signers;
  const SignedRecord start = signers.start(chain(std::vector<std::string>(500, "ur3")));
  const auto compact = compact_start(start, true);
  REQUIRE(compact);
  CHECK(compact->bytes.size() < 700);
  CHECK(compact->bytes.size() * 3 < compact_start(start, false)->bytes.size());
  CHECK((encode(open_compact_start(*compact, true)->scenario) ==
         encode(decode<RunStart>(start.payload.bytes)->scenario)));
}

TEST_CASE("ids that count on in other ways, or not at all, come back") {
  Signers signers;
  const auto scenario_of = [](const std::vector<std::string>& ids) {
    Scenario out = chain(std::vector<std::string>(ids.size(), "ur3"));
    for (std::size_t i = 0; i < ids.size(); ++i) out.tasks[i].id = ids[i];
    out.tasks.back().after = {0, static_cast<std::uint16_t>(ids.size() - 2)};
    return out;
  };
  for (const std::vector<std::string>& ids : {std::vector<std::string>{"t9", "t10", "t11", "t12"},
                                              {"t08", "t09", "t10", "t010"},
                                              {"99", "100", "0", "1"},
                                              {"lift", "carry", "t", "t1"},
                                              {"a9b", "a10b", std::string(64, '9'), "b"}}) {
    const Scenario scenario = scenario_of(ids);
    const auto compact = compact_start(signers.start(scenario), true);
    REQUIRE(compact);
    CHECK((open_compact_start(*compact, true)->scenario == scenario));
  }
}
