// NODE_DIR/state/gateway.db: what the gateway must still know after kill -9. SQLite, WAL, synchronous=FULL.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "services/cloud-gateway/core/access/audit_chain.hpp"
#include "services/cloud-gateway/core/access/sessions.hpp"
#include "services/cloud-gateway/core/access/tokens.hpp"
#include "services/cloud-gateway/core/access/users.hpp"
#include "services/cloud-gateway/core/live/idempotency.hpp"

namespace trb::gateway {

/// A head that the node's router has signed, as the router gave it.
struct SignedHead {
  std::uint64_t number = 0;
  Bytes record;  ///< the encoded SignedRecord
};

/// What a start finds.
struct StoredState {
  std::vector<User> users;
  std::vector<Session> sessions;
  std::vector<Token> tokens;
  std::vector<StoredRequest> requests;
  std::optional<AuditRow> last_audit;
  std::uint64_t signed_to = 0;  ///< the highest number of a signed head
  UtcTime steady;               ///< the last stored steady time
};

/// What is written together, in one transaction: all of it or nothing.
struct StoreBatch {
  std::vector<Change<User>> users;
  std::vector<Change<Session>> sessions;
  std::vector<Change<Token>> tokens;
  std::vector<StoredRequest> requests;
  std::vector<RequestKey> dropped_requests;
  std::vector<AuditRow> audit;
  std::vector<SignedHead> heads;
  std::optional<UtcTime> steady;
  [[nodiscard]] bool empty() const;
};

/// Which audit records: the newest first, below `before`.
struct AuditQuery {
  std::optional<std::uint64_t> before;
  std::size_t most = 100;  ///< 1 to 1000
  std::string who;         ///< empty: of everybody
};

class GatewayDb {
 public:
  /// Opens or creates it (0600), migrates an older schema; a newer one is refused. Errors: io_error, malformed.
  static Result<std::unique_ptr<GatewayDb>> open(const std::string& path);
  GatewayDb() = default;
  GatewayDb(const GatewayDb&) = delete;
  GatewayDb& operator=(const GatewayDb&) = delete;
  virtual ~GatewayDb() = default;

  virtual Result<StoredState> load() = 0;
  virtual Status save(const StoreBatch& batch) = 0;
  virtual Result<std::vector<AuditRow>> audit(const AuditQuery& query) = 0;
  /// For a check of the whole chain: `most` rows from that number on, in order.
  virtual Result<std::vector<AuditRow>> audit_from(std::uint64_t number, std::size_t most) = 0;
  virtual Result<std::vector<SignedHead>> heads() = 0;
};

}  // namespace trb::gateway
