// Whom a connection has asked, and for how long that is known.
#include <doctest/doctest.h>

#include "services/router/core/asked.hpp"

using namespace trb::router;

namespace {

constexpr Party kArm = party_of_peer(1);
constexpr Party kBelt = party_of_peer(2);
constexpr Party kService = party_of_connection(1);
constexpr std::uint64_t kId = 7ULL << 48U | 0x1234'5678ULL << 16U | 9U;

}  // namespace

TEST_CASE("only who was asked may answer, as often as it likes") {
  Asked asked;
  asked.note(kId, true, kArm);
  CHECK(asked.may_answer(kId, false, kArm));
  CHECK(asked.may_answer(kId, false, kArm));
  CHECK(asked.may_answer(kId, true, kArm));
  CHECK_FALSE(asked.may_answer(kId, false, kBelt));
  CHECK_FALSE(asked.may_answer(kId, true, kBelt));
  CHECK_FALSE(asked.may_answer(kId, false, kService));  // of the same number
  CHECK_FALSE(asked.may_answer(kId, false, Party::nobody));
}

TEST_CASE("what was never asked has no answer: another count, another random part, nothing at all") {
  Asked asked;
  CHECK_FALSE(asked.may_answer(kId, false, kArm));
  asked.note(kId, true, kArm);
  CHECK_FALSE(asked.may_answer(kId + 1, false, kArm));
  CHECK_FALSE(asked.may_answer(kId + (1ULL << 16U), false, kArm));
  CHECK_FALSE(asked.may_answer(0, false, kArm));
  CHECK_FALSE(asked.may_answer(0, true, Party::nobody));
}

TEST_CASE("nothing that bears no id is ever answered") {
  Asked asked;
  asked.note(0, true, kArm);
  CHECK_FALSE(asked.may_answer(0, false, kArm));
}

TEST_CASE("a newer question takes the place of one that is a whole table older") {
  Asked asked;
  asked.note(kId, true, kArm);
  for (std::uint64_t i = 1; i < Asked::kQuestions; ++i) asked.note(kId + i, true, kBelt);
  CHECK(asked.may_answer(kId, false, kArm));
  asked.note(kId + Asked::kQuestions, true, kBelt);
  CHECK_FALSE(asked.may_answer(kId, false, kArm));
  CHECK(asked.may_answer(kId + Asked::kQuestions, false, kBelt));
}

TEST_CASE("a user's information is only Nacked, and a flood of it pushes out no question") {
  Asked asked;
  asked.note(kId, true, kArm);
  for (std::uint64_t i = 1; i <= 2 * Asked::kQuestions; ++i) asked.note(kId + i, false, kBelt);
  CHECK(asked.may_answer(kId, false, kArm));
  const std::uint64_t last = kId + 2 * Asked::kQuestions;
  CHECK(asked.may_answer(last, true, kBelt));
  CHECK_FALSE(asked.may_answer(last, false, kBelt));
  CHECK_FALSE(asked.may_answer(last, true, kArm));
  CHECK_FALSE(asked.may_answer(kId + 1, true, kBelt));  // overwritten
}
