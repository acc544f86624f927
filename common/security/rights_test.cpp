// The one table of who may what.
#include <doctest/doctest.h>

#include <algorithm>

#include "common/base/files.hpp"
#include "common/security/rights.hpp"
#include "common/security/services.hpp"
#include "proto/body.hpp"
#include "tests/support/paths.hpp"

using namespace trb;

TEST_CASE("over a link goes what the table names for the role, and a user's own words") {
  for (const Role role : {Role::robot, Role::cloud}) {
    for (const std::string_view word : {"stop", "baton", "ack", "hello", "fleet_news", "move", "a_word_of_a_user"}) {
      CHECK(may_cross(role, word));
    }
    for (const std::string_view word : {"execute", "sign_request", "signed_record", "peer_expired", "service_welcome",
                                        "run_submit", "certificate", "journal_abort", "revocation_list"}) {
      CHECK_FALSE(may_cross(role, word));
    }
    CHECK(may_cross(role, "robot_fault") == (role == Role::robot));
    CHECK_FALSE(may_send_out(role, "goodbye"));  // a service cannot end a link
    CHECK_FALSE(may_send_out(role, "seal"));
    CHECK(may_send_out(role, "move"));
    CHECK(may_send_out(role, "echo_request"));
    for (const std::string_view word : {"run_decision", "release_tasks"})
      CHECK(may_send_out(role, word) == (role == Role::cloud));
    CHECK(may_send_out(role, "robot_state") == (role == Role::robot));
  }
}

TEST_CASE("a decision is the cloud's, a result the robot's, a certificate no node's") {
  CHECK(may_sign(Role::cloud, kSignedDecision));
  CHECK_FALSE(may_sign(Role::robot, kSignedDecision));
  CHECK(may_sign(Role::robot, kSignedResult));
  CHECK(may_sign(Role::cloud, kSignedResult));  // of a task that its decision skips
  for (const Role role : {Role::robot, Role::cloud}) {
    CHECK(may_sign(role, kSignedSeal));
    CHECK(may_sign(role, kSignedRelayed));
    CHECK_FALSE(may_sign(role, kSignedRevocations));
  }
}

TEST_CASE("the head of an audit log is signed by a cloud node, for its gateway alone") {
  CHECK(may_sign(Role::cloud, kSignedAuditHead));
  CHECK_FALSE(may_sign(Role::robot, kSignedAuditHead));
  CHECK(may_have_signed("cloud-gateway", false, kSignedAuditHead));
  for (const std::string_view service : {"scheduler", "resilience", "router", "fault-tally", ""}) {
    CHECK_FALSE(may_have_signed(service, false, kSignedAuditHead));
  }
  CHECK_FALSE(may_have_signed("cloud-gateway", true, kSignedAuditHead));  // a probe that uses that name
}

TEST_CASE("the gateway runs on a cloud node that names it, on no robot's") {
  const auto runs = [](const std::vector<std::string>& services, const char* name) {
    return std::ranges::find(services, name) != services.end();
  };
  CHECK(runs(services_of(Role::cloud), "cloud-gateway"));
  CHECK_FALSE(runs(default_services_of(Role::cloud), "cloud-gateway"));
  CHECK_FALSE(runs(services_of(Role::robot), "cloud-gateway"));
}

TEST_CASE("a record is signed for the service that makes its kind alone") {
  CHECK(may_have_signed("scheduler", false, kSignedResult));
  CHECK_FALSE(may_have_signed("scheduler", true, kSignedResult));  // a probe that uses that name
  CHECK(may_have_signed("cli", true, kSignedRunStart));
  CHECK_FALSE(may_have_signed("mode-adapter", false, kSignedRunStart));
  CHECK(may_have_signed("resilience", false, kSignedDecision));
  for (const std::string_view purpose : {kSignedBeacon, kSignedSeal, kSignedRelayed, kSignedCertificate,
                                         kSignedRevocations, std::string_view("anything"), std::string_view()}) {
    CHECK_FALSE(may_have_signed("scheduler", false, purpose));
    CHECK_FALSE(may_have_signed("", false, purpose));
    CHECK_FALSE(may_have_signed("cli", true, purpose));
  }
}

TEST_CASE("on the bus a service says what it is for, and nobody says what the router says") {
  CHECK(may_send_on_bus("scheduler", false, "execute"));
  CHECK(may_send_on_bus("mode-adapter", false, "outcome"));
  CHECK(may_send_on_bus("mode-adapter", false, "service_alive"));
  CHECK(may_send_on_bus("cli", true, "run_submit"));
  CHECK(may_send_on_bus("cli", true, "stop"));
  CHECK(may_send_on_bus("cli", true, "a_word_of_a_user"));
  for (const std::string_view subtype : {"execute", "outcome", "adapter_state", "node_profile", "peer_expired",
                                         "signed_record", "hello", "certificate", "journal_abort"}) {
    CHECK_FALSE(may_send_on_bus("scheduler", true, subtype));  // a probe, whatever its name
    CHECK_FALSE(may_send_on_bus("resilience", false, subtype));
  }
  // From node to node any service may send, except what takes a task from a robot.
  CHECK(may_send_on_bus("resilience", false, "release_tasks"));
  CHECK(may_send_on_bus("scheduler", false, "run_decision"));
  for (const std::string_view subtype : {"release_tasks", "run_decision"}) {
    CHECK_FALSE(may_send_on_bus("cli", true, subtype));
    CHECK_FALSE(may_send_on_bus("fault-tally", false, subtype));
  }
}

TEST_CASE("a service of an operator's takes users' words, and nothing of the middleware's") {
  CHECK(may_take("scheduler", "baton"));
  CHECK(may_take("fault-tally", "fault_tally"));
  for (const std::string_view subtype : {"baton", "execute", "robot_fault", "stop", "outcome", "journal_run"}) {
    CHECK_FALSE(may_take("fault-tally", subtype));
  }
  for (const std::string_view name : {"router", "cloud-gateway", "probe", "tap"}) CHECK(is_reserved_service(name));
  CHECK_FALSE(is_reserved_service("fault-tally"));
  CHECK_FALSE(may_have_signed("fault-tally", false, kSignedRunAbort));
  CHECK_FALSE(may_send_on_bus("fault-tally", false, "execute"));
}

TEST_CASE("proto/README.md prints the table as it is") {
  const auto readme = read_file(test::source_dir() + "/proto/README.md");
  REQUIRE(readme.ok());
  INFO("put the output of `trb help rights` between the marks");
  CHECK(readme->find("<!-- rights -->\n" + rights_text() + "<!-- /rights -->") != std::string::npos);
}
