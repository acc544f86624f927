#include "common/security/invitation.hpp"

#include <doctest/doctest.h>

#include "proto/body.hpp"

using namespace trb;

namespace {

constexpr UtcTime kNow{1'772'366'400'000'000'000};

struct Hall {
  SigningKey key = (init_crypto(), make_signing_key());
  FleetAuthority fleet{"hall", key.public_key};
  [[nodiscard]] SignedRecord invite(Duration time = kInvitationTime) const {
    const Bytes caller = invitation_keys("secret").caller.public_key;
    return sign_invitation({{fleet.id()}, "arm", Role::robot, {caller}, (kNow + time).ns}, key);
  }
};

}  // namespace

TEST_CASE("the keys of a secret are always the same, and nothing of another's or of each other") {
  init_crypto();
  const InvitationKeys one = invitation_keys("secret");
  CHECK(invitation_keys("secret").caller.secret_key == one.caller.secret_key);
  CHECK(one.to_node != one.to_inviter);
  CHECK(invitation_keys("secreu").to_node != one.to_node);
  CHECK(invitation_keys("secreu").caller.public_key != one.caller.public_key);
}

TEST_CASE("a box opens with its key alone, unchanged") {
  const InvitationKeys keys = (init_crypto(), invitation_keys("secret"));
  const Bytes box = lock_join(keys.to_node, "hello");
  CHECK(*unlock_join(keys.to_node, box) == "hello");
  CHECK(box.find("hello") == Bytes::npos);
  CHECK(lock_join(keys.to_node, "hello") != box);
  CHECK(unlock_join(keys.to_inviter, box).error().code == Errc::wrong_key);
  for (std::size_t i = 0; i < box.size(); ++i) {
    Bytes wrong = box;
    wrong[i] = static_cast<char>(wrong[i] ^ 1);
    CHECK_FALSE(unlock_join(keys.to_node, wrong).ok());
    CHECK_FALSE(unlock_join(keys.to_node, box.substr(0, i)).ok());
  }
}

TEST_CASE("an invitation holds until its end, of this fleet's authority alone") {
  const Hall hall;
  const Hall other;
  const SignedRecord record = hall.invite();
  CHECK(open_invitation(record, hall.fleet, kNow)->name == "arm");
  CHECK(open_invitation(record, hall.fleet, kNow + kInvitationTime).error().code == Errc::expired);
  CHECK(open_invitation(record, other.fleet, kNow).error().code == Errc::foreign_fleet);
  CHECK(open_invitation(hall.invite(std::chrono::hours(2)), hall.fleet, kNow).error().code == Errc::bad_value);
  SignedRecord forged = record;
  forged.signature = other.invite().signature;
  CHECK(open_invitation(forged, hall.fleet, kNow).error().code == Errc::bad_signature);
  forged = record;
  forged.kind = kSignedCertificate;
  CHECK(open_invitation(forged, hall.fleet, kNow).error().code == Errc::bad_signature);
  CHECK_FALSE(open_invitation({}, hall.fleet, kNow).ok());
}

TEST_CASE("bytes are the same, or not") {
  CHECK(same_bytes("ab", "ab"));
  CHECK_FALSE(same_bytes("ab", "ac"));
  CHECK_FALSE(same_bytes("ab", "abc"));
  CHECK(same_bytes("", ""));
}

TEST_CASE("where a cloud node was reached is kept for it alone, and the list stays as long as it may be") {
  const auto seed = [](int i, const std::string& host) {
    return FleetSeed{host + ":45000", {Bytes(32, char('a' + i))}};
  };
  std::vector<FleetSeed> seeds{seed(0, "10.0.0.1"), seed(1, "10.0.0.2")};
  dial_at(seeds, seed(1, "192.168.1.7"));
  CHECK(seeds == std::vector<FleetSeed>{seed(1, "192.168.1.7"), seed(0, "10.0.0.1")});
  seeds.clear();
  for (int i = 0; i < int{kMaxFleetSeeds}; ++i) seeds.push_back(seed(i, "10.0.0.1"));
  dial_at(seeds, seed(20, "10.0.0.9"));
  CHECK(seeds.size() == kMaxFleetSeeds);
  CHECK(seeds.front().address == "10.0.0.9:45000");
}
