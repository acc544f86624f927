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

RouteTable table_of(Fleet& fleet, const std::vector<std::string>& nodes) {
  RouteTable out;
  for (const std::string& node : nodes) {
    Route route;
    route.id = node;
    route.certificate = fleet[node].certificate;
    out.routes.push_back(std::move(route));
  }
  return out;
}

}  // namespace

TEST_CASE("who knows the members makes the same bytes again of a start that travelled without their certificates") {
  Signers signers;
  const SignedRecord start = signers.start(chain({"ur3", "drone", "pioneer", "ur3", "drone", "pioneer"}));
  const auto compact = compact_start(start);
  REQUIRE(compact);
  CHECK(compact->bytes.size() * 3 < start.payload.bytes.size());
  const auto read = open_compact_start(*compact);
  REQUIRE(read);
  CHECK(read->run == kKnownRun);
  KnownCertificates known;
  CHECK_FALSE(known.complete(*read));
  std::vector<std::string> nodes;
  for (const Member& member : read->members) nodes.push_back(member.id);
  known.learn(table_of(signers.fleet, nodes));
  const auto complete = known.complete(*read);
  REQUIRE(complete);
  CHECK((encode(*complete) == start.payload.bytes));
  nodes.pop_back();
  known.learn(table_of(signers.fleet, nodes));
  CHECK_FALSE(known.complete(*read));
}

TEST_CASE(
    "an assignment that the tasks do not name travels; an electorate that does not follow keeps the start whole") {
  Signers signers;
  const RunStart read = *decode<RunStart>(signers.start(chain({"ur3", "drone"})).payload.bytes);
  const auto travels = [&](const RunStart& start) {
    const SignedRecord record = signers.sign("cloud", kSignedRunStart, encode(start));
    const auto compact = compact_start(record);
    if (!compact) return false;
    std::vector<std::string> nodes;
    for (const Member& member : start.members) nodes.push_back(member.id);
    KnownCertificates known;
    known.learn(table_of(signers.fleet, nodes));
    const auto complete = known.complete(*open_compact_start(*compact));
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
  CHECK_FALSE(compact_start(start));
  start.payload.bytes = "none";
  CHECK_FALSE(compact_start(start));
}

TEST_CASE("what is no start, or would be too large, is refused") {
  CHECK(open_compact_start({"x"}).error().code == Errc::malformed);
  CHECK_FALSE(open_compact_start({deflated("no start")}).ok());
  // NOLINTNEXTLINE(bugprone-string-constructor): it is to be large
  CHECK(open_compact_start({deflated(Bytes(10'000'000, 'a'))}).error().code == Errc::too_large);
  // Few bytes cost their reader little.
  CHECK(open_compact_start({deflated(Bytes(100'000, 'a'))}).error().code == Errc::too_large);
}

TEST_CASE("a start that says one thing a thousand times travels whole") {
  Signers signers;
  RunStart read = *decode<RunStart>(signers.start(chain({"ur3", "drone"})).payload.bytes);
  for (Task& task : read.scenario.tasks) task.data = std::string(60'000, 'x');
  read = build_run_start(read.scenario, read.members, "cloud", {10}, {20}, kKnownRun);
  CHECK_FALSE(compact_start(signers.sign("cloud", kSignedRunStart, encode(read))));
}
