#include "common/scenario/decision_rule.hpp"

#include <doctest/doctest.h>

#include "proto/body.hpp"

using namespace trb;

namespace {

Member member(const std::string& id, Role role) {
  Certificate certificate;
  certificate.id = id;
  certificate.role = role;
  return {id, {"certificate", "", {encode(certificate)}, {}}};
}

RunStart start_of(std::vector<Member> members) {
  RunStart start;
  start.submitter = "ur3";
  start.members = std::move(members);
  return start;
}

}  // namespace

TEST_CASE("the first cloud node among the members decides, and judges the end") {
  const DecisionRule rule(
      start_of({member("ur3", Role::robot), member("north", Role::cloud), member("cloud", Role::cloud)}));
  CHECK(rule.decider() == "north");
  CHECK(rule.judge() == "north");
  CHECK(rule.may_decide("north"));
  CHECK_FALSE(rule.may_decide("cloud"));
  CHECK_FALSE(rule.may_decide("ur3"));
}

TEST_CASE("without a cloud node nobody decides, and the submitter judges the end") {
  const DecisionRule rule(start_of({member("drone", Role::robot), member("ur3", Role::robot)}));
  CHECK(rule.decider().empty());
  CHECK(rule.judge() == "ur3");
  CHECK_FALSE(rule.may_decide(""));
  CHECK_FALSE(rule.may_decide("ur3"));
}

TEST_CASE("a member whose certificate cannot be read is no cloud node") {
  CHECK(first_cloud_of({{"cloud", {"certificate", "", {"no certificate"}, {}}}}).empty());
}
