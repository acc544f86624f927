// What the gateway must still know after kill -9: NODE_DIR/state/gateway.db (SQLite, WAL, synchronous=FULL) of one
// gateway, or a PostgreSQL database that several of them share.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/audit/audit_chain.hpp"
#include "common/base/result.hpp"
#include "services/cloud-gateway/core/access/sessions.hpp"
#include "services/cloud-gateway/core/access/tokens.hpp"
#include "services/cloud-gateway/core/access/users.hpp"
#include "services/cloud-gateway/core/alarms/alarm.hpp"
#include "services/cloud-gateway/core/live/idempotency.hpp"
#include "services/cloud-gateway/core/scenarios/scenario_shelf.hpp"

namespace trb::gateway {

/// A head that the node's router has signed, as the router gave it.
struct SignedHead {
  std::uint64_t number = 0;
  Bytes record;  ///< the encoded SignedRecord
  bool operator==(const SignedHead&) const = default;
};

/// What a gateway keeps in memory; each kind changes by itself. The audit's is its end.
enum class StoreKind : std::uint8_t { users = 0, sessions, tokens, requests, scenarios, acknowledged, shelves, audit };
constexpr auto enum_names(StoreKind) {
  return std::array<std::string_view, 8>{"users",     "sessions",     "tokens",  "requests",
                                         "scenarios", "acknowledged", "shelves", "audit"};
}
using StoreKinds = std::set<StoreKind>;
StoreKinds all_kinds();

/// What a start finds; or, of a shared store, what has changed.
struct StoredState {
  StoreKinds kinds;  ///< which of these were read
  std::vector<User> users;
  std::vector<Session> sessions;
  std::vector<Token> tokens;
  std::vector<StoredRequest> requests;
  std::vector<StoredScenario> scenarios;
  std::vector<Acknowledgement> acknowledged;
  std::vector<Shelf> shelves;
  std::optional<AuditRow> last_audit;
  std::uint64_t signed_to = 0;    ///< the highest number of a signed head
  std::optional<UtcTime> steady;  ///< the last stored steady time; empty: none was stored yet
  /// It was brought back from a backup of that time, and that is not on record yet; with every load of a file.
  std::optional<UtcTime> restored;
  std::string chain_node;  ///< of a shared store: the node whose audit chain it is; with every load
};

/// What is written together, in one transaction: all of it or nothing. Requests are dropped before new ones are put, so
/// that an expired key can be used again in the same batch; then those that are there are moved.
struct StoreBatch {
  std::vector<Change<User>> users;
  std::vector<Change<Session>> sessions;
  std::vector<Change<Token>> tokens;
  std::vector<StoredRequest> requests;
  std::vector<RequestKey> dropped_requests;
  std::vector<MovedRequest> moved_requests;
  std::vector<Change<StoredScenario>> scenarios;
  std::vector<Change<Acknowledgement>> acknowledged;
  std::vector<Change<Shelf>> shelves;
  std::vector<AuditRow> audit;
  std::vector<SignedHead> heads;
  std::optional<UtcTime> steady;
  bool notes_restored = false;  ///< that it was brought back from a backup is among these records
  [[nodiscard]] bool empty() const;
  /// Which kinds it changes.
  [[nodiscard]] StoreKinds kinds() const;
};

/// Which audit records: the newest first, with numbers below `before`.
struct AuditQuery {
  std::optional<std::uint64_t> before;
  std::size_t most = 100;  ///< 1 to 1000
  std::string who;         ///< empty: of everybody
};

/// The texts are stored as they are. Errors of every call: io_error (a full disk, no rights), malformed (damaged), each
/// with a hint; of a shared one peer_unreachable (the server does not answer). After an error the object can be used
/// further.
class GatewayDb {
 public:
  /// A file of this gateway alone. Opens or creates it. It has the mode 0600 from the beginning; an existing one gets
  /// it. Migrates an older schema. Error besides: version_mismatch (a newer build wrote it).
  static Result<std::unique_ptr<GatewayDb>> open(const std::string& path);
  GatewayDb() = default;
  GatewayDb(const GatewayDb&) = delete;
  GatewayDb& operator=(const GatewayDb&) = delete;
  virtual ~GatewayDb() = default;

  /// True: other gateways write into it too. What is in memory holds until the next refresh() alone.
  [[nodiscard]] virtual bool is_shared() const = 0;
  /// All kinds.
  virtual Result<StoredState> load() = 0;
  /// The kinds that another gateway has changed since this one has read them.
  virtual Result<StoredState> refresh() = 0;
  /// On disk once it returns Done. Error besides: conflict. It says that another gateway has changed the same store:
  /// a kind that the batch changes is another one by now (of a shared store, once it was loaded), the batch would leave
  /// no enabled admin, or its audit records do not follow the last one (they have no gaps, and none is ever replaced).
  /// The objects in memory are out of date then.
  virtual Status save(const StoreBatch& batch) = 0;
  /// Error besides: bad_value (`most`).
  virtual Result<std::vector<AuditRow>> audit(const AuditQuery& query) = 0;
  /// For a check of the whole chain: `most` rows from that number on, in order.
  virtual Result<std::vector<AuditRow>> audit_from(std::uint64_t number, std::size_t most) = 0;
  /// Those of records `first` to `last`, by number. Of several heads with the same number the first is kept: it covers
  /// the same records.
  virtual Result<std::vector<SignedHead>> heads(std::uint64_t first, std::uint64_t last) = 0;
  /// Of a shared store: the certificates of all nodes whose gateways have written into it, as they are encoded.
  virtual Result<std::vector<Bytes>> certificates() = 0;
};

}  // namespace trb::gateway
