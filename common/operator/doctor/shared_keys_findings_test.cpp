// What the doctor says of keys that two computers use.
#include "common/operator/doctor/shared_keys_findings.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::op;

namespace {

/// The node ant, linked with bee, whose router has these errors.
struct Shared {
  Observed seen;
  Shared() {
    seen.node = "ant";
    seen.answers = seen.inbox_open = true;
    seen.seeds = 1;
    seen.own = Certificate{};
    seen.own->serial = 7;
    seen.own->not_after = 300 * std::int64_t{86'400'000'000'000};
    seen.routes = {"ant", {}};
    for (const std::string id : {"ant", "bee"}) {
      Route route;
      route.id = id;
      route.state = id == "ant" ? "self" : "ONLINE";
      route.address = id + ":1";
      seen.routes.routes.push_back(route);
    }
  }
  void row(const std::string& peer, const std::string& code, const std::string& text, std::uint64_t count,
           double last) {
    seen.errors.errors.push_back({peer, "", code, text, count, last});
  }
};

}  // namespace

TEST_CASE("keys that two computers use are a problem of their own: who, where, and what to do") {
  Shared ant;
  ant.row("bee", "conflict", "boot 8 of 'bee' while its boot 9 is linked", 3, 1);
  ant.row("bee", "shared_keys", "two computers use the keys of 'bee', at 10.0.0.8:1 and 10.0.0.9:1", 1, 1);
  const auto found = diagnose(ant.seen);
  REQUIRE(found.size() == 1);
  CHECK(found[0].weight == Weight::problem);
  CHECK(found[0].cause == "shared_keys");
  CHECK(found[0].subject == "bee");
  CHECK(found[0].what == "two computers use the keys of 'bee', at 10.0.0.8:1 and 10.0.0.9:1");
  CHECK(found[0].hint.find("trb fleet revoke FLEET_DIR SERIAL") != std::string::npos);
  CHECK(found[0].hint.find("look at the robot itself") != std::string::npos);
}

TEST_CASE("after an hour without a sign it is a note, after a day nothing") {
  Shared ant;
  ant.row("bee", "shared_keys", "two", 1, 3600);
  CHECK(diagnose(ant.seen).at(0).weight == Weight::problem);
  CHECK(diagnose(ant.seen).at(0).what == "two; last seen 60 min ago");
  ant.seen.errors.errors[0].last_s = 3601;
  CHECK(diagnose(ant.seen).at(0).weight == Weight::note);
  ant.seen.errors.errors[0].last_s = 86'401;
  CHECK(diagnose(ant.seen).empty());
}

TEST_CASE("who asks about another node is not told of it") {
  Shared ant;
  ant.row("bee", "shared_keys", "two", 1, 1);
  ant.seen.asked = "ant:1";
  CHECK(diagnose(ant.seen).empty());
}

TEST_CASE(
    "the node that is kept out learns that another has its keys; a few refusals are a start that has just ended") {
  Shared ant;
  ant.row("bee", "refused_us", "conflict", 9, 1);
  REQUIRE(diagnose(ant.seen).size() == 1);
  CHECK(diagnose(ant.seen)[0].cause == "old_start");
  ant.seen.errors.errors[0].count = 10;
  const auto found = diagnose(ant.seen);
  REQUIRE(found.size() == 1);
  CHECK(found[0].cause == "shared_keys");
  CHECK(found[0].subject == "ant");
  CHECK(found[0].what ==
        "two computers use this node's keys (certificate serial 7): another one is linked at bee, which therefore "
        "refuses this one");
}

TEST_CASE("an older start alone stays what it is") {
  Shared ant;
  ant.row("bee", "conflict", "boot 8 of 'bee' while its boot 9 is linked", 1, 1);
  const auto found = diagnose(ant.seen);
  REQUIRE(found.size() == 1);
  CHECK(found[0].cause == "old_start");
}
