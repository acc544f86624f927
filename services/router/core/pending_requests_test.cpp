// Whom a connection has sent requests, and for how long that is known.
#include <doctest/doctest.h>

#include "services/router/core/pending_requests.hpp"

using namespace trb::router;

namespace {

constexpr Party kArm = party_of_peer(1);
constexpr Party kBelt = party_of_peer(2);
constexpr Party kService = party_of_connection(1);
constexpr std::uint64_t kId = 7ULL << 48U | 0x1234'5678ULL << 16U | 9U;

}  // namespace

TEST_CASE("only who was asked may answer, as often as it likes") {
  PendingRequests pending;
  pending.note(kId, true, kArm);
  CHECK(pending.may_answer(kId, false, kArm));
  CHECK(pending.may_answer(kId, false, kArm));
  CHECK(pending.may_answer(kId, true, kArm));
  CHECK_FALSE(pending.may_answer(kId, false, kBelt));
  CHECK_FALSE(pending.may_answer(kId, true, kBelt));
  CHECK_FALSE(pending.may_answer(kId, false, kService));  // of the same number
  CHECK_FALSE(pending.may_answer(kId, false, Party::nobody));
}

TEST_CASE("what was never asked has no answer: another count, another random part, nothing at all") {
  PendingRequests pending;
  CHECK_FALSE(pending.may_answer(kId, false, kArm));
  pending.note(kId, true, kArm);
  CHECK_FALSE(pending.may_answer(kId + 1, false, kArm));
  CHECK_FALSE(pending.may_answer(kId + (1ULL << 16U), false, kArm));
  CHECK_FALSE(pending.may_answer(0, false, kArm));
  CHECK_FALSE(pending.may_answer(0, true, Party::nobody));
}

TEST_CASE("nothing that bears no id is ever answered") {
  PendingRequests pending;
  pending.note(0, true, kArm);
  CHECK_FALSE(pending.may_answer(0, false, kArm));
}

TEST_CASE("a newer question takes the place of one that is a whole table older") {
  PendingRequests pending;
  pending.note(kId, true, kArm);
  for (std::uint64_t i = 1; i < PendingRequests::kQuestions; ++i) pending.note(kId + i, true, kBelt);
  CHECK(pending.may_answer(kId, false, kArm));
  pending.note(kId + PendingRequests::kQuestions, true, kBelt);
  CHECK_FALSE(pending.may_answer(kId, false, kArm));
  CHECK(pending.may_answer(kId + PendingRequests::kQuestions, false, kBelt));
}

TEST_CASE("a user's information is only Nacked, and a flood of it pushes out no question") {
  PendingRequests pending;
  pending.note(kId, true, kArm);
  for (std::uint64_t i = 1; i <= 2 * PendingRequests::kQuestions; ++i) pending.note(kId + i, false, kBelt);
  CHECK(pending.may_answer(kId, false, kArm));
  const std::uint64_t last = kId + 2 * PendingRequests::kQuestions;
  CHECK(pending.may_answer(last, true, kBelt));
  CHECK_FALSE(pending.may_answer(last, false, kBelt));
  CHECK_FALSE(pending.may_answer(last, true, kArm));
  CHECK_FALSE(pending.may_answer(kId + 1, true, kBelt));  // overwritten
}
