// Which clocks of the authority's computer are believed.
#include "common/security/signing_clock.hpp"

#include "common/security/test_hall.hpp"

using namespace trb;
using namespace trb::test;

namespace {

bool is_right(const Hall& hall, UtcTime now, std::optional<UtcTime> node = std::nullopt) {
  const Status right = check_signing_clock(hall.authority, node, now);
  if (right) return true;
  CHECK(right.error().code == Errc::conflict);
  CHECK(right.error().what.find(to_iso8601(now)) != std::string::npos);
  CHECK(right.error().hint.find("--trust-clock") != std::string::npos);
  return false;
}

}  // namespace

TEST_CASE("a folder that has signed nothing believes any clock, but not one that the node contradicts") {
  const Hall hall;
  CHECK(is_right(hall, UtcTime{0}));
  CHECK(is_right(hall, kNow + 50 * kYear));
  CHECK_FALSE(is_right(hall, UtcTime{0}, kNow));
  CHECK_FALSE(is_right(hall, kNow + kYear, kNow));
}

TEST_CASE("a clock before what the folder has signed is wrong, and one over a year behind it") {
  Hall hall;
  hall.join("ur3");
  const UtcTime begin{hall.living("ur3").not_before};
  CHECK(is_right(hall, begin - kSigningBehind));
  CHECK_FALSE(is_right(hall, begin - kSigningBehind - Duration(1)));
  CHECK(is_right(hall, begin + kLongestUnused));
  CHECK_FALSE(is_right(hall, begin + kLongestUnused + Duration(1)));
  REQUIRE(revoke_certificates(hall.authority, hall.dir, {}, "", kNow + kYear).ok());
  CHECK_FALSE(is_right(hall, kNow));
  CHECK(is_right(hall, kNow + 2 * kYear));
}

TEST_CASE("what was signed by a clock that was ahead binds only until something is signed by a right one") {
  Hall hall;
  hall.join("ur3");
  REQUIRE(renew_certificates(hall.authority, hall.dir, {hall.living("ur3")}, kNow + kYear, kYear).ok());
  REQUIRE(revoke_certificates(hall.authority, hall.dir, {}, "", kNow + kYear).ok());
  CHECK_FALSE(is_right(hall, kNow));
  REQUIRE(revoke_certificates(hall.authority, hall.dir, {}, "", kNow).ok());
  CHECK_FALSE(is_right(hall, kNow));
  hall.join("ur3");
  CHECK(is_right(hall, kNow));
}

TEST_CASE("a node that has noted the time lately bounds the clock more closely") {
  Hall hall;
  hall.join("ur3");
  CHECK(is_right(hall, kNow + kLongestNodeOff, kNow));
  CHECK_FALSE(is_right(hall, kNow + kLongestNodeOff + Duration(1), kNow));
  CHECK(is_right(hall, kNow, kNow + kSigningBehind));
  CHECK_FALSE(is_right(hall, kNow, kNow + kSigningBehind + Duration(1)));
}

TEST_CASE("a clock by which every member has ended is wrong for a revocation; who was revoked counts for none") {
  Hall hall;
  CHECK(check_members_clock(hall.authority, kNow + 9 * kYear).ok());
  hall.join("ur3");
  hall.join("ur5");
  CHECK(check_members_clock(hall.authority, kNow + kYear - Duration(1)).ok());
  CHECK(check_members_clock(hall.authority, kNow + kYear).error().code == Errc::conflict);
  REQUIRE(sign_request(hall.authority, hall.dir, hall.request("cloud", "cloud"), kNow, 2 * kYear).ok());
  CHECK(check_members_clock(hall.authority, kNow + kYear).ok());
  for (const char* id : {"ur3", "ur5", "cloud"}) REQUIRE(hall.revoke(id).ok());
  CHECK(check_members_clock(hall.authority, kNow + 9 * kYear).ok());
}
