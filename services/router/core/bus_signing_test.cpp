// Which service may have what signed.
#include <doctest/doctest.h>

#include "services/router/test/test_bus.hpp"

using namespace trb;
using namespace trb::router;

TEST_CASE("each kind of record is signed for its one maker") {
  Bus bus;
  const std::vector<std::string> services = {"scheduler", "mode-adapter", "resilience", "sensor-bus", "cloud-gateway"};
  ConnectionId id = 0;
  for (const std::string& service : services) REQUIRE(bus.hello(++id, service) == "service_welcome");
  REQUIRE(bus.hello(++id, "scheduler", {}, true) == "service_welcome");  // a probe, whatever name it gives
  const auto asks = [&](ConnectionId from, std::string_view kind) {
    return bus.ask(from, SignRequest{std::string(kind), {payload_of(kind, "ant")}});
  };
  for (ConnectionId from = 1; from <= 6; ++from) {
    CAPTURE(from);
    const bool person = from == 5 || from == 6;
    CHECK(asks(from, kSignedResult) == (from == 1 ? "signed_record" : "not_permitted"));
    CHECK(asks(from, kSignedChoice) == (from == 1 ? "signed_record" : "not_permitted"));
    CHECK(asks(from, kSignedRunStart) == (person ? "signed_record" : "not_permitted"));
    CHECK(asks(from, kSignedRunAbort) == (person || from == 1 || from == 3 ? "signed_record" : "not_permitted"));
    CHECK(asks(from, kSignedRunPause) == (person || from == 1 ? "signed_record" : "not_permitted"));
    CHECK(asks(from, kSignedDecision) == "not_permitted");  // it is no cloud node
    CHECK(asks(from, kSignedAuditHead) == "not_permitted");
    for (const auto kind : {kSignedCertificate, kSignedRequest, kSignedBeacon})
      CHECK(asks(from, kind) == "not_permitted");
  }
}

TEST_CASE("a record that names another node, or nothing that can be read, is not signed") {
  Bus bus;
  REQUIRE(bus.hello(1, "scheduler") == "service_welcome");
  CHECK(bus.ask(1, SignRequest{std::string(kSignedResult), {payload_of(kSignedResult, "bee")}}) == "source_mismatch");
  CHECK(bus.ask(1, SignRequest{std::string(kSignedChoice), {payload_of(kSignedChoice, "bee")}}) == "source_mismatch");
  CHECK(bus.ask(1, SignRequest{std::string(kSignedResult), {"noise"}}) == "source_mismatch");
}

TEST_CASE("a decision is signed on a cloud node for its resilience, and names that node") {
  Bus bus{Role::cloud};
  REQUIRE(bus.hello(1, "resilience") == "service_welcome");
  const auto asks = [&](const std::string& by) {
    return bus.ask(1, SignRequest{std::string(kSignedDecision), {payload_of(kSignedDecision, by)}});
  };
  CHECK(asks("ant") == "signed_record");
  CHECK(asks("bee") == "source_mismatch");
}

TEST_CASE("the head of an audit log is signed on a cloud node, for its gateway alone") {
  Bus bus{Role::cloud};
  REQUIRE(bus.hello(1, "cloud-gateway") == "service_welcome");
  REQUIRE(bus.hello(2, "resilience") == "service_welcome");
  REQUIRE(bus.hello(3, "cloud-gateway", {}, true) == "service_welcome");  // a probe of that name
  const auto asks = [&](ConnectionId from) { return bus.ask(from, SignRequest{"audit_head", {"a head"}}); };
  REQUIRE(asks(1) == "signed_record");
  const auto record = decode<SignedRecord>(bus.ant.bus.back().message.data);
  CHECK(record->kind == kSignedAuditHead);
  CHECK(record->signer == "ant");
  CHECK(record->payload.bytes == "a head");
  CHECK(asks(2) == "not_permitted");
  CHECK(asks(3) == "not_permitted");
}
