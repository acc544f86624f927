// The largest size of each body by the bounds of its fields: if it exceeds a message's 1 MiB, another place bounds it.
#include <doctest/doctest.h>

#include <map>

#include "proto/message.hpp"
#include "proto/shape.hpp"
#include "tests/contract/fill.hpp"

using namespace trb;

namespace {

std::uint64_t largest(const Shape& shape, std::uint32_t max) {
  constexpr std::uint64_t kHead = 5;
  switch (shape.kind) {
    case FieldKind::boolean:
    case FieldKind::enumeration:
      return 1;
    case FieldKind::uint16:
      return 3;
    case FieldKind::uint32:
      return 5;
    case FieldKind::uint64:
    case FieldKind::int64:
    case FieldKind::number:
      return 9;
    case FieldKind::text:
    case FieldKind::blob:
      return kHead + max;
    case FieldKind::list:
      return kHead + max * largest(*shape.list.item, kDefaultMaxSize);
    case FieldKind::record:
      break;
  }
  std::uint64_t sum = kHead;
  for (const FieldEntry& field : shape.fields) sum += largest(*field.shape, field.max);
  return sum;
}

/// Bodies that exceed a message by their fields' bounds, and what keeps them within one.
const std::map<std::string, std::string> kBounded = {
    // Between nodes and services.
    {"alert_ranking", "resilience proposer: rank_by"},
    {"alert_table", "resilience alert_book: fit"},
    {"baton", "scheduler run/deliveries: kMostPassed; delivery_sender: pack_results"},
    {"definition", "scheduler run/decision_checks"},
    {"fleet_news", "router TrustUpdates: kMaxUpdate"},
    {"hello", "router handshake: kMaxHelloSize"},
    {"neighbours", "router reachable_peers: kMostAtOnce certificates, each signed by the authority"},
    {"node_profile", "router local_profile, link_inbox: kMaxProfileSize"},
    {"results", "scheduler delivery_sender: pack_results"},
    {"route_table", "router answers: pages"},
    {"run_records", "scheduler signed_records: page_of"},
    {"run_table", "scheduler RunStore::kMaxRuns, 512 of 1.4 kB; pages of 500"},
    {"run_view", "scheduler view: fit"},
    // Never messages of their own: they are contents of a SignedRecord, 512 kB at most, or rows of a database.
    {"alert", "alert_table; in the database: resilience proposals: kMostNamed"},
    {"decision", "SignRequest::payload"},
    {"join_offer", "invite: kMostList; it travels as HoldInvitation::offer, 32 kB"},
    {"run_start", "SignRequest::payload"},
    {"scenario", "SignRequest::payload, as part of run_start"},
};

}  // namespace

TEST_CASE("every body is within a message by the bounds of its fields, or has a place that bounds it") {
  for (const contract::AnyBody& is : contract::every_body()) {
    const std::uint64_t size = largest(shape_of(is.kind), kDefaultMaxSize);
    INFO(is.subtype, ": ", size, " bytes");
    CHECK((size > kMaxDataSize) == kBounded.contains(std::string(is.subtype)));
  }
}

TEST_CASE("what a reader would refuse is not packed: a list or blob over its bound, the whole, a number that is none") {
  RobotState state;
  state.values.resize(32);
  CHECK(pack(state).ok());
  state.values.resize(33);
  REQUIRE_FALSE(pack(state).ok());
  CHECK(pack(state).error().text() == "too_large: values: list over 32 items");
  CHECK_FALSE(decode<RobotState>(encode(state)).ok());

  SignRequest request{"result", {std::string((1U << 19U) + 1, 'x')}};
  CHECK(pack_body(request).error().text() == "too_large: sign_request: payload: over 524288 bytes; send less at once");
  request.payload.bytes.pop_back();
  CHECK(pack(request).ok());

  Execute execute;
  execute.timeout_s = 1.0 / 0.0;
  CHECK(pack(execute).error().text() == "bad_value: timeout_s: not a finite number");

  TrustUpdate update;
  update.certificates.assign(3, SignedRecord{"x", "y", {std::string(1U << 19U, 'x')}, {}});
  CHECK(pack(update).error().code == Errc::too_large);
  CHECK(pack_body(Opaque{"word", std::string(kMaxDataSize, 'x')}).ok());
  CHECK(pack_body(Opaque{"word", std::string(kMaxDataSize + 1, 'x')}).error().code == Errc::too_large);
}

TEST_CASE("what is packed is what encode makes, and its reader takes it") {
  for (const contract::AnyBody& is : contract::every_body()) {
    CAPTURE(is.subtype);
    const Body body = contract::filled(is.kind);
    const auto packed = pack_body(body);
    REQUIRE(packed.ok());
    CHECK(*packed == is.encode(body));
    CHECK(is.decode(*packed).ok());
  }
}
