// What the authority signs while a fleet is up, and three linked nodes that receive it.
#pragma once

#include <doctest/doctest.h>

#include "common/security/revocations.hpp"
#include "services/router/test/test_fleet.hpp"

namespace trb::router {

inline SignedRecord sign_list(const TestAuthority& authority, RevocationList list) {
  list.fleet = {authority.fleet.id()};
  list.issued = kStartUtc;
  return sign(kSignedRevocations, "", authority.fleet.id(), encode(list), authority.key);
}

/// List `number`: revokes these ids up to serial 1, which it says to have ended, so that the next list may lack them;
/// the beacon key's box is for the named nodes.
inline SignedRecord list_of(const TestAuthority& authority, std::uint64_t number,
                            const std::vector<std::string>& out_ids, const std::vector<std::string>& staying = {}) {
  RevocationList list;
  list.number = number;
  list.beacon_number = static_cast<std::uint32_t>(number + 1);
  for (const std::string& id : out_ids) list.revoked.push_back({1, id, "stolen", kStartUtc, kStartUtc});
  for (const std::string& id : staying) list.beacon_keys.push_back({id, {Bytes(80, 'b')}});
  return sign_list(authority, list);
}

/// Three linked nodes: ant, bee, cat.
struct Three {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  TestNode& bee = fleet.start("bee");
  TestNode& cat = fleet.start("cat");
  Three() {
    fleet.run(std::chrono::seconds(2));
    REQUIRE(linked({&ant, &bee, &cat}));
  }
  static bool linked(const std::vector<TestNode*>& nodes) {
    for (const TestNode* a : nodes) {
      for (const TestNode* b : nodes) {
        if (a != b && a->link_to(b->id) == 0) return false;
      }
    }
    return true;
  }
  Result<std::string> tell(TestNode& node, const TrustUpdate& update) {
    Effects effects;
    auto taken = node.core->updates().on_update(update, 0, fleet.now, effects);
    fleet.carry_out(node, effects);
    return taken;
  }
  Errc code(TestNode& node, const TrustUpdate& update) {
    const auto taken = tell(node, update);
    return taken ? Errc::ok : taken.error().code;
  }
  Certificate renewed(const std::string& id, std::uint64_t serial) {
    Certificate certificate = fleet.keys(id).certificate;
    certificate.serial = serial;
    certificate.not_after = kStartUtc + std::chrono::nanoseconds(std::chrono::hours(24 * 300)).count();
    return certificate;
  }
  SignedRecord sign_certificate(const Certificate& certificate) const {
    return sign(kSignedCertificate, "", fleet.authority.fleet.id(), encode(certificate), fleet.authority.key);
  }
};

/// A new node of the same id, with other keys.
inline Certificate of_another(const TestFleet& fleet, const std::string& id, std::uint64_t serial) {
  return fleet.authority.sign_node(id, Role::robot, serial).certificate;
}

inline bool logged(const TestNode& node, const std::string& text) {
  return std::any_of(node.log.begin(), node.log.end(),
                     [&](const std::string& line) { return line.find(text) != std::string::npos; });
}

}  // namespace trb::router
