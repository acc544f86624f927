// A router core with keys that the fuzzers know: they sign what a signature check would stop.
#pragma once

#include "services/router/core/router_core.hpp"
#include "services/router/test/test_keys.hpp"
#include "services/router/test/test_words.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {

/// The keys of "ant" (the router) and of "bee" and "cat", made once.
struct Keys {
  router::TestAuthority authority;
  router::TestKeys ant = authority.sign_node("ant");
  router::TestKeys bee = authority.sign_node("bee");
  router::TestKeys cat = authority.sign_node("cat", Role::cloud);

  static const Keys& get() {
    init_crypto();
    static const Keys keys;
    return keys;
  }
  /// The authority's signature on any payload.
  [[nodiscard]] SignedRecord sign_as_authority(std::string_view kind, const Bytes& payload) const {
    return sign(kind, "", authority.fleet.id(), payload, authority.key);
  }
};

constexpr Now kNow{{1'000'000'000}, {router::kStartUtc}};

inline router::RouterCore make_router() {
  const Keys& keys = Keys::get();
  router::RouterConfig config;
  config.id = "ant";
  config.authority = keys.authority.fleet;
  config.certificate = keys.ant.record;
  config.own = keys.ant.certificate;
  config.identity = keys.ant.identity;
  config.address = "10.0.0.1:45000";
  config.services = {"router", "scheduler"};
  config.random = random_u64;
  return router::RouterCore(std::move(config));
}

/// After any input: the table has only nodes that the authority has signed, and its rows are bounded.
inline void check_table(const router::RouterCore& core) {
  require(core.table().peers().size() <= router::kMaxPeers, "the table is bounded");
  for (const auto& [id, peer] : core.table().peers()) {
    const auto certificate = open_certificate_any_time(peer.certificate_record, Keys::get().authority.fleet);
    require(certificate.ok(), "every peer has a certificate of the authority");
    require(certificate->id == id, "every peer stands under its own id");
  }
}

/// A member's Hello, as a body.
inline Hello make_hello(const router::TestKeys& keys, const std::string& id) {
  return {keys.record,
          3,
          id == "bee" ? "10.0.0.2:45000" : "10.0.0.3:45000",
          "1.0",
          router::kStartUtc,
          true,
          {},
          0,
          "behind",
          false,
          ""};
}

}  // namespace trb::fuzz
