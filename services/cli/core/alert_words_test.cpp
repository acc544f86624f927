#include "services/cli/core/alert_words.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::cli;

namespace {

CriterionPart part(const std::string& robot, const std::string& criterion, double value = 80) {
  return {criterion, value, "%", 0.5, 0.12, robot};
}

}  // namespace

TEST_CASE("a value that nobody has measured is not shown as a number") {
  Proposal arm{"abb1", {{"go", "abb1"}}, 1, {}, "distance is 30 s old", 1};
  CHECK(part_text(arm, part("abb1", "battery")) == "battery 80 % (0.120)");
  arm.note += "; battery is not known, taken as the others' mean";
  CHECK(part_text(arm, part("abb1", "battery")) == "battery not known (0.120)");
  CHECK(part_text(arm, part("abb1", "distance")) == "distance 80 % (0.120)");
  arm.note = "battery is not known";
  CHECK(part_text(arm, part("abb1", "battery", 0)) == "battery not known (0.120)");
}

TEST_CASE("of several robots that take over each value is told with its robot") {
  const Proposal both{"",
                      {{"go", "near"}, {"grab", "full"}},
                      1,
                      {},
                      "near: position is 9 s old; battery is not known; full: distance is not known",
                      1};
  CHECK(part_text(both, part("near", "battery")) == "near battery not known (0.120)");
  CHECK(part_text(both, part("near", "distance")) == "near distance 80 % (0.120)");
  CHECK(part_text(both, part("full", "battery")) == "full battery 80 % (0.120)");
  CHECK(part_text(both, part("full", "distance")) == "full distance not known (0.120)");
}

TEST_CASE("proposals hold until they expire: then that is said, and no time") {
  Alert alert;
  CHECK(hold_text(alert, {5}).empty());  // no run needs the robot
  alert.run = "aa11";
  alert.cause = "task_failed";
  alert.policy = "ask";
  alert.expires = 2'000'000'000;
  const std::string holds = "policy: ask; proposals hold until 1970-01-01T00:00:02.000Z";
  const std::string expired = "policy: ask; proposals have expired, and are made anew when one is accepted";
  CHECK(hold_text(alert, {5}) == holds);
  CHECK(hold_text(alert, {2'000'000'000}) == expired);
  alert.state = AlertState::expired;
  CHECK(hold_text(alert, {5}) == expired);
  alert.cause = "double_execution";
  CHECK(hold_text(alert, {5}).empty());
}

TEST_CASE("an alert tells what is lost") {
  Alert alert;
  alert.cause = "robot_fault";
  CHECK(lost_of(alert) == "all of it");
  alert.capability = "carry";
  CHECK(lost_of(alert) == "carry");
  CHECK(lost_of({}) == "-");
}
