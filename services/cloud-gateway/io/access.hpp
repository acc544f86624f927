// Users, sessions, tokens, sign-ins, stored scenarios and the audit log, kept in the database.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "services/cloud-gateway/core/access/audit_heads.hpp"
#include "services/cloud-gateway/core/access/request_check.hpp"
#include "services/cloud-gateway/core/access/sign_in.hpp"
#include "services/cloud-gateway/core/live/idempotency.hpp"
#include "services/cloud-gateway/io/store/gateway_db.hpp"

namespace trb::gateway {

/// All of it is in memory; commit() writes what has changed since. Reply to a request only after it.
class Access {
 public:
  /// `origins`: see RequestCheck. `chain`: audit_start() of this node. Errors: those of GatewayDb::load.
  static Result<std::unique_ptr<Access>> open(GatewayDb& db, std::vector<std::string> origins, const Bytes& chain);
  Access(const Access&) = delete;
  Access& operator=(const Access&) = delete;

  /// Adds what somebody did to the audit log.
  void note(AuditRecord record);
  /// The node's router has signed a head.
  void keep(SignedHead head);
  /// A request with an Idempotency-Key, before it acts and once it is answered.
  void keep(StoredRequest request) { kept_.push_back(std::move(request)); }
  /// In one transaction. Errors: those of GatewayDb::save; then what memory holds is not on disk, so the process must
  /// end.
  Status commit();
  /// Ends what has expired: sessions by steady time, idempotency keys.
  void tick(Now now, UtcTime steady);

 private:
  Access(GatewayDb& db, std::vector<std::string> origins, const Bytes& chain, const StoredState& stored);
  void restore(StoredState stored);

  GatewayDb& db_;

 public:
  Users users;
  Sessions sessions;
  Tokens tokens;
  SignInGuard guard;
  SignIn sign_in;
  RequestCheck check;
  AuditChain chain;
  AuditHeads heads;
  Idempotency requests;
  ScenarioShelf scenarios;
  SteadyTime time;  ///< UTC that does not jump: for sessions and tokens

 private:
  std::vector<AuditRow> noted_;
  std::vector<SignedHead> signed_;
  std::vector<StoredRequest> kept_;
  std::vector<RequestKey> expired_;
  std::optional<MonotonicTime> timed_;  ///< when the steady time was stored last
  std::optional<UtcTime> steady_;
};

}  // namespace trb::gateway
