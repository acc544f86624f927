#include "services/resilience/core/uncovered_faults.hpp"

#include <doctest/doctest.h>

#include "services/resilience/test/fleet_fixture.hpp"

using namespace trb;
using namespace trb::resilience;

namespace {

Now at(double s) {
  return {MonotonicTime{} + seconds(s), at_second(0)};
}

}  // namespace

TEST_CASE("a fault is untold 2 s after it came, and 2 s after the last alert has told of it; lesser ones never") {
  Fleet fleet;
  UncoveredFaults uncovered;
  uncovered.follow(fleet, at(0));
  CHECK_FALSE(uncovered.next(at(0)));
  fleet.on_fault("r1", {"mobile", Severity::critical, "stuck"}, at_second(0));
  fleet.on_fault("r1", {"grab", Severity::urgent, "weak"}, at_second(0));
  uncovered.follow(fleet, at(1));
  CHECK(uncovered.next(at(1)) == at(3).mono);
  CHECK(uncovered.uncovered(at(2.9)).empty());
  CHECK(uncovered.uncovered(at(3)) == std::vector<UncoveredFaults::Key>{{"r1", "mobile"}});
  uncovered.cover({"r1", "mobile"}, at(10));
  CHECK(uncovered.uncovered(at(11)).empty());
  CHECK(uncovered.next(at(11)) == at(12).mono);
  fleet.on_fault("r2", {"", Severity::fatal, "dead"}, at_second(0));
  uncovered.follow(fleet, at(11));
  CHECK(uncovered.uncovered(at(12)) == std::vector<UncoveredFaults::Key>{{"r1", "mobile"}});
  fleet.end_faults("r1", "mobile", "mended", at_second(12));
  uncovered.follow(fleet, at(13));
  CHECK(uncovered.uncovered(at(13)) == std::vector<UncoveredFaults::Key>{{"r2", ""}});
  fleet.forget("r2", at_second(14));
  uncovered.follow(fleet, at(14));
  CHECK(uncovered.uncovered(at(20)).empty());
}
