// Whom a connection has sent requests, and for how long that is known.
#include <doctest/doctest.h>

#include "services/router/core/sent_requests.hpp"

using namespace trb::router;

namespace {

constexpr Party kArm = party_of_peer(1);
constexpr Party kBelt = party_of_peer(2);
constexpr Party kService = party_of_connection(1);
constexpr std::uint64_t kId = 7ULL << 48U | 0x1234'5678ULL << 16U | 9U;

}  // namespace

TEST_CASE("only who got the request may answer, as often as it likes") {
  SentRequests sent;
  sent.note(kId, true, kArm);
  CHECK(sent.may_answer(kId, false, kArm));
  CHECK(sent.may_answer(kId, false, kArm));
  CHECK(sent.may_answer(kId, true, kArm));
  CHECK_FALSE(sent.may_answer(kId, false, kBelt));
  CHECK_FALSE(sent.may_answer(kId, true, kBelt));
  CHECK_FALSE(sent.may_answer(kId, false, kService));  // of the same number
  CHECK_FALSE(sent.may_answer(kId, false, Party::nobody));
}

TEST_CASE("what was never sent has no answer: another count, another random part, nothing at all") {
  SentRequests sent;
  CHECK_FALSE(sent.may_answer(kId, false, kArm));
  sent.note(kId, true, kArm);
  CHECK_FALSE(sent.may_answer(kId + 1, false, kArm));
  CHECK_FALSE(sent.may_answer(kId + (1ULL << 16U), false, kArm));
  CHECK_FALSE(sent.may_answer(0, false, kArm));
  CHECK_FALSE(sent.may_answer(0, true, Party::nobody));
}

TEST_CASE("nothing that bears no id is ever answered") {
  SentRequests sent;
  sent.note(0, true, kArm);
  CHECK_FALSE(sent.may_answer(0, false, kArm));
}

TEST_CASE("a newer request takes the place of one that is a whole table older") {
  SentRequests sent;
  sent.note(kId, true, kArm);
  for (std::uint64_t i = 1; i < SentRequests::kRequests; ++i) sent.note(kId + i, true, kBelt);
  CHECK(sent.may_answer(kId, false, kArm));
  sent.note(kId + SentRequests::kRequests, true, kBelt);
  CHECK_FALSE(sent.may_answer(kId, false, kArm));
  CHECK(sent.may_answer(kId + SentRequests::kRequests, false, kBelt));
}

TEST_CASE("a user's information is only Nacked, and a flood of it pushes out no request") {
  SentRequests sent;
  sent.note(kId, true, kArm);
  for (std::uint64_t i = 1; i <= 2 * SentRequests::kRequests; ++i) sent.note(kId + i, false, kBelt);
  CHECK(sent.may_answer(kId, false, kArm));
  const std::uint64_t last = kId + 2 * SentRequests::kRequests;
  CHECK(sent.may_answer(last, true, kBelt));
  CHECK_FALSE(sent.may_answer(last, false, kBelt));
  CHECK_FALSE(sent.may_answer(last, true, kArm));
  CHECK_FALSE(sent.may_answer(kId + 1, true, kBelt));  // overwritten
}
