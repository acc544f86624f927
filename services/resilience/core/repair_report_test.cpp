#include "services/resilience/core/repair_report.hpp"

#include <doctest/doctest.h>

#include "tests/support/at.hpp"

using namespace trb;
using namespace trb::resilience;

TEST_CASE("a node that does not answer is told again, later and later") {
  RepairReport repair;
  CHECK(repair.is_due(at(0)));
  CHECK_FALSE(repair.next());
  repair.on_sent(at(0));
  CHECK_FALSE(repair.is_due(at(0.1)));
  CHECK(repair.is_due(at(0.2)));
  repair.on_sent(at(0.2));
  CHECK_FALSE(repair.is_due(at(0.5)));
  CHECK(repair.is_due(at(0.6)));
}

TEST_CASE("a node that has taken its robot into use is told again after ten seconds") {
  RepairReport repair;
  repair.on_taken(at(0));  // it was not notified yet
  CHECK(repair.is_due(at(0)));
  repair.on_sent(at(0));
  repair.on_taken(at(1));
  CHECK_FALSE(repair.is_due(at(10.9)));
  CHECK(repair.is_due(at(11)));
}

TEST_CASE("a refusal counts once the profile has had its time to say otherwise") {
  RepairReport repair;
  repair.on_refused("too early", at(0));
  CHECK_FALSE(repair.refusal(at(100)));
  repair.on_sent(at(0));
  repair.on_refused("not repaired", at(1));
  repair.on_refused("again", at(2));
  CHECK_FALSE(repair.is_due(at(50)));
  CHECK_FALSE(repair.refusal(at(3.9)));
  CHECK(repair.refusal(at(4)) == "not repaired");
}

TEST_CASE("a refusal after the node has answered, or after the profile has, is late") {
  RepairReport repair;
  repair.on_sent(at(0));
  repair.on_taken(at(1));
  repair.on_refused("late", at(2));
  CHECK_FALSE(repair.refusal(at(100)));
  RepairReport done;
  done.on_sent(at(0));
  done.on_done();
  done.on_refused("late", at(2));
  CHECK(done.is_done());
  CHECK_FALSE(done.refusal(at(100)));
}
