// What a router does at its start, and what its table shows of each node.
#include "services/router/core/router_core.hpp"

#include <doctest/doctest.h>

#include "services/router/test/test_fleet.hpp"

using namespace trb;
using namespace trb::router;

namespace {

bool logs(const Effects& effects, const std::string& event) {
  return std::any_of(effects.list.begin(), effects.list.end(), [&](const Effect& effect) {
    const auto* line = std::get_if<Log>(&effect);
    return line != nullptr && line->event == event;
  });
}

Route row(const TestFleet& fleet, const TestNode& node, const std::string& id) {
  for (const Route& one : node.core->answers().route_table(fleet.now).routes) {
    if (one.id == id) return one;
  }
  return {};
}

}  // namespace

TEST_CASE("a node whose own address is among its seeds and hints does not dial itself, nor a hint that is a name") {
  TestFleet fleet;
  fleet.hosts["hub.example:45000"] = fleet.address("cat");
  TestNode& ant = fleet.start("ant", {.beacon = false,
                                      .seeds = {"ant", "bee"},
                                      .known = {"ant", "bee", "dog"},
                                      .known_names = {{"cat", "hub.example:45000"}}});
  fleet.run(Seconds(1));
  CHECK(std::count_if(ant.dials.begin(), ant.dials.end(),
                      [&](const Dial& dial) { return dial.address == fleet.address("ant"); }) == 0);
  CHECK(std::count_if(ant.dials.begin(), ant.dials.end(),
                      [&](const Dial& dial) { return dial.address == fleet.address("cat"); }) == 0);
  CHECK(std::count_if(ant.dials.begin(), ant.dials.end(),
                      [&](const Dial& dial) { return dial.address == fleet.address("dog"); }) > 0);
  const auto to_bee = std::count_if(ant.dials.begin(), ant.dials.end(),
                                    [&](const Dial& dial) { return dial.address == fleet.address("bee"); });
  const auto to_dog = std::count_if(ant.dials.begin(), ant.dials.end(),
                                    [&](const Dial& dial) { return dial.address == fleet.address("dog"); });
  CHECK(to_bee == to_dog);  // a hint with a seed's key is not a second seed
}

TEST_CASE("what was in force before a start is in force after it, before anything is said") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  RevocationList list;
  list.fleet = {fleet.authority.fleet.id()};
  list.number = 3;
  list.revoked = {{1, "ant", "stolen", kStartUtc}};
  RouterConfig config = ant.core->config();
  config.updates.revocations =
      sign(kSignedRevocations, "", fleet.authority.fleet.id(), encode(list), fleet.authority.key);
  RouterCore again(config);
  Effects effects;
  again.start(fleet.now, effects);
  CHECK(std::count(effects.counts.begin(), effects.counts.end(), "news.lists") == 1);
  CHECK(logs(effects, "own_certificate_over"));
}

TEST_CASE("a node that starts with a certificate that has ended says so at once; a clock that is behind, too") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  const auto starts = [&](UtcTime utc) {
    RouterCore again(ant.core->config());
    Effects effects;
    again.start({fleet.now.mono, utc}, effects);
    return effects;
  };
  const Certificate& own = ant.keys.certificate;
  CHECK_FALSE(logs(starts({own.not_after - 1}), "own_certificate_over"));
  CHECK(logs(starts({own.not_after}), "own_certificate_over"));
  CHECK_FALSE(logs(starts({own.not_before}), "clock_unverified"));
  CHECK(logs(starts({own.not_before - 1}), "clock_unverified"));
}

TEST_CASE("the table says of each node whether it is there, since when it is silent, and who dialled") {
  TestFleet fleet;
  TestNode& ant = fleet.start_two(Seconds(2));
  TestNode& bee = fleet.at("bee");
  const Route there = row(fleet, ant, "bee");
  CHECK(there.state == "ONLINE");
  CHECK(there.last_heard_s < 3);
  CHECK(there.clock == "verified");
  CHECK(there.dialled_by == row(fleet, bee, "ant").dialled_by);
  CHECK(there.dialled_by == (ant.core->table().link(ant.link_to("bee"))->dialled ? "ant" : "bee"));
  CHECK(row(fleet, ant, "ant").state == "self");
  CHECK(row(fleet, ant, "ant").clock == "verified");
  fleet.stop("bee");
  fleet.run(Seconds(4));
  CHECK(row(fleet, ant, "bee").dialled_by.empty());
  fleet.run(Seconds(10));
  CHECK(row(fleet, ant, "bee").state == "OFFLINE");
  CHECK(row(fleet, ant, "bee").last_heard_s > 8);
  // Only what comes behind a page's last row.
  const RouteTable rest = ant.core->answers().route_table(fleet.now, "ant");
  REQUIRE(rest.routes.size() == 1);
  CHECK(rest.routes[0].id == "bee");
  CHECK_FALSE(rest.more);
}
