#include "services/cloud-gateway/io/access.hpp"

#include "common/security/keys.hpp"
#include "common/security/password_hash.hpp"

namespace trb::gateway {
namespace {

/// How much of the steady time a kill may cost; each step is a write.
constexpr Duration kTimeStep = std::chrono::minutes(1);

AuditChain chain_of(const Bytes& start, const std::optional<AuditRow>& last) {
  return last ? AuditChain(start, *last) : AuditChain(start);
}

}  // namespace

Result<std::unique_ptr<Access>> Access::open(GatewayDb& db, std::vector<std::string> origins, const Bytes& chain) {
  auto stored = db.load();
  if (!stored) return stored.error();
  std::unique_ptr<Access> out(new Access(db, std::move(origins), chain, *stored));
  out->restore(std::move(*stored));
  return out;
}

Access::Access(GatewayDb& db, std::vector<std::string> origins, const Bytes& chain_start, const StoredState& stored)
    : db_(db),
      users(random_bytes),
      sessions(random_bytes),
      tokens(random_bytes),
      sign_in(users, sessions, guard, hash_password(new_secret(random_bytes))),
      check(std::move(origins), users, sessions, tokens),
      chain(chain_of(chain_start, stored.last_audit)),
      scenarios(random_bytes) {}

void Access::restore(StoredState stored) {
  for (User& user : stored.users) users.restore(std::move(user));
  for (Session& session : stored.sessions) sessions.restore(std::move(session));
  for (Token& token : stored.tokens) tokens.restore(std::move(token));
  for (StoredScenario& scenario : stored.scenarios) scenarios.restore(std::move(scenario));
  if (stored.steady) {
    requests.restore(stored.requests, *stored.steady);
    time.restore(*stored.steady);
  }
  heads.signed_to(stored.signed_to);
}

void Access::note(AuditRecord record) {
  noted_.push_back(chain.append(std::move(record)));
}

void Access::keep(SignedHead head) {
  heads.signed_to(head.number);
  signed_.push_back(std::move(head));
}

Status Access::commit() {
  StoreBatch batch;
  batch.users = users.take_changes();
  batch.sessions = sessions.take_changes();
  batch.tokens = tokens.take_changes();
  batch.scenarios = scenarios.take_changes();
  batch.audit = std::exchange(noted_, {});
  batch.heads = std::exchange(signed_, {});
  batch.requests = std::exchange(kept_, {});
  batch.dropped_requests = std::exchange(expired_, {});
  batch.steady = std::exchange(steady_, {});
  return batch.empty() ? Status(Done{}) : db_.save(batch);
}

void Access::tick(Now now, UtcTime steady) {
  sessions.tick(users, steady);
  for (RequestKey& key : requests.take_expired(now)) expired_.push_back(std::move(key));
  if (timed_ && now.mono - *timed_ < kTimeStep) return;
  timed_ = now.mono;
  steady_ = steady;
}

}  // namespace trb::gateway
