// What a fleet authority issues to nodes, for tests.
#pragma once

#include <cstdint>
#include <string>

#include "common/security/keys.hpp"
#include "proto/bodies/link.hpp"

namespace trb::router {

constexpr std::int64_t kStartUtc = 1'772'366'400'000'000'000;

/// What a fleet authority would have issued to a node.
struct TestKeys {
  SigningKey identity = make_signing_key();
  LinkKey link = make_link_key();
  SignedRecord record;
  Certificate certificate;
};

struct TestAuthority {
  SigningKey key = make_signing_key();
  FleetAuthority fleet{"hall", key.public_key};

  /// The same keys, with the right to relay.
  void let_relay(TestKeys& keys) const {
    keys.certificate.relay = true;
    keys.record = sign(kSignedCertificate, "", fleet.id(), encode(keys.certificate), key);
  }

  TestKeys sign_node(const std::string& id, Role role = Role::robot, std::uint64_t serial = 1) const {
    TestKeys keys;
    keys.certificate = {{fleet.id()},
                        serial,
                        id,
                        role,
                        {keys.identity.public_key},
                        {keys.link.public_key},
                        kStartUtc - 1'000'000'000,
                        kStartUtc + 86'400'000'000'000,
                        false};
    keys.record = sign(kSignedCertificate, "", fleet.id(), encode(keys.certificate), key);
    return keys;
  }
};

}  // namespace trb::router
