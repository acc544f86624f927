#include "services/resilience/core/ranker.hpp"

#include <doctest/doctest.h>

#include "services/resilience/test/fleet_fixture.hpp"

using namespace trb;
using namespace trb::resilience;

TEST_CASE("the place of a task is what its skill takes as a place, and no text that happens to be a place's name") {
  Fleet fleet;
  NodeProfile profile = carrier();
  profile.skills.back().parameters.push_back({"label", "text", false, ""});
  REQUIRE(tell_profile(fleet, "a", profile, at_second(0)));
  const HallPlaces places{{"dock", {1, 2}}, {"table1", {3, 4}}};
  CHECK_FALSE(place_of(*fleet.find("a"), {load({{"label", Value{"dock"}}})}, places).has_value());
  const auto place = place_of(*fleet.find("a"), {load({{"label", Value{"dock"}}}), drive("table1")}, places);
  REQUIRE(place.has_value());
  CHECK(place->x == 3);
}
