// Two gateways' memories on one database.
#pragma once

#include <doctest/doctest.h>

#include <memory>
#include <string>
#include <vector>

#include "common/security/keys.hpp"
#include "services/cloud-gateway/io/access.hpp"
#include "services/cloud-gateway/io/store/test/store_folder.hpp"

namespace trb::gateway::test {

inline constexpr UtcTime kNow{1'800'000'000'000'000'000};
inline const std::vector<std::string> kOrigins{"https://localhost:8443"};

/// A gateway: its connection, and its memory.
struct OneGateway {
  OneGateway(const StoreFolder& folder, const std::string& node) : db(opened(folder, node)) {
    auto made = Access::open(*db, kOrigins, {"fleet", node});
    REQUIRE_MESSAGE(made.ok(), (made ? "" : made.error().text()));
    access = std::move(*made);
  }
  void note(const std::string& who) const { access->note({0, 5, who, "::1", "POST /api/v1/runs", "run-1", "done"}); }
  void refresh() const { REQUIRE(access->refresh().ok()); }

  std::unique_ptr<GatewayDb> db;
  std::unique_ptr<Access> access;
};

/// Two gateways with ann, an admin, and bob, another one.
struct TwoGateways {
  TwoGateways() {
    init_crypto();
    REQUIRE(a.access->users.add("ann", UserRole::admin, "hash", kNow));
    REQUIRE(a.access->users.add("bob", UserRole::admin, "hash", kNow));
    REQUIRE(a.access->commit());
    b.refresh();
  }
  [[nodiscard]] NewSession sign_in(const std::string& user) const {
    NewSession out = a.access->sessions.open(*a.access->users.find(user), kNow);
    REQUIRE(a.access->commit());
    b.refresh();
    return out;
  }
  [[nodiscard]] bool is_known(const OneGateway& gateway, const NewSession& session, UtcTime now = kNow) const {
    return gateway.access->sessions.find(session.id, gateway.access->users, now) != nullptr;
  }

  StoreFolder folder;
  OneGateway a{folder, "cloud"};
  OneGateway b{folder, "cloud2"};
};

inline void on_postgres(void (*body)()) {
  with_store(true, body);
}

}  // namespace trb::gateway::test
