// Users, sessions, tokens, sign-ins, stored scenarios, alarms and the audit log, kept in the database.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "services/cloud-gateway/core/access/audit_heads.hpp"
#include "services/cloud-gateway/core/access/refusal_log.hpp"
#include "services/cloud-gateway/core/access/request_check.hpp"
#include "services/cloud-gateway/core/access/sign_in.hpp"
#include "services/cloud-gateway/core/alarms/alarm_desk.hpp"
#include "services/cloud-gateway/core/live/idempotency.hpp"
#include "services/cloud-gateway/io/held.hpp"
#include "services/cloud-gateway/io/store/gateway_db.hpp"

namespace trb::gateway {

/// Whose audit log it is; of a shared store its first gateway's node.
struct AuditOrigin {
  Bytes fleet;
  std::string node;
};

/// All of it is in memory; commit() writes what has changed since. Reply to a request only after it.
///
/// Of a shared store, which other gateways write too, memory is a copy:
///
/// state   | event                                     | then
/// --------|-------------------------------------------|---------------------------------------------------------------
/// current | refresh(): others have changed some kinds | current, with theirs
/// current | commit(), nobody changed what it changes  | current
/// current | commit(), the audit log, sessions, alarms | current: added to theirs
/// -       | or answers of requests have gone on       |
/// current | commit(), users, tokens or scenarios were | current, with theirs; conflict; the key of a request that was
/// -       | changed, or a key was used                | refused so is free again
/// any     | commit() of signed heads alone, no answer | stale; they wait, and it is no error
/// any     | the server does not answer                | stale: what it wanted to write is lost, and it says so
/// stale   | refresh(), and the server answers         | current: all is read anew
/// stale   | owe(): a stop was ordered, one drives     | stale; the record waits for pay_owed()
///
/// A file is this gateway's alone, and memory has all that is in it. If commit() finds no room there (io_error), it is
/// unwritten() until a commit() or retry() finds some. Meanwhile who is signed in, answers of requests, signed heads,
/// what alarms do of themselves and the gateway's own records wait, and are no error. What somebody has decided (users,
/// tokens, scenarios, alarms) is undone, and a noted record is refused; owe() keeps one of what was done all the same.
class Access {
 public:
  /// `origins`: see RequestCheck. Errors: those of GatewayDb::load; a shared store that cannot be read yet is none.
  static Result<std::unique_ptr<Access>> open(GatewayDb& db, std::vector<std::string> origins, AuditOrigin origin);
  Access(const Access&) = delete;
  Access& operator=(const Access&) = delete;

  /// Adds what somebody did to the audit log.
  void note(AuditRecord record);
  /// What was done although it could not be written: written as soon as the database answers again. False: there is no
  /// room for it.
  bool owe(AuditRecord record);
  [[nodiscard]] std::size_t owed() const { return owed_.size(); }
  /// The same of what must not take the room from stops.
  bool owe_lesser(AuditRecord record);
  [[nodiscard]] bool may_owe_lesser() const;
  /// Writes what is owed, but for what is stored all the same: of a commit whose answer was lost. Errors: those of
  /// commit(); then it is owed further.
  Status pay_owed();
  /// The node's router has signed a head; `record` is its SignedRecord, encoded. False: the database has no such
  /// record, or does not answer. A head that is stored is proof: one of a record that never was would accuse the log
  /// for ever.
  bool keep(const AuditHead& head, Bytes record);
  /// If the file comes from a backup: the next commit says so in the log, before all else.
  void note_restored(UtcTime now);
  /// A request with an Idempotency-Key, before it acts and once it is answered.
  void keep(StoredRequest request) { kept_.push_back(std::move(request)); }
  /// Nobody knows whether it was done: its answer says so, and so does a record.
  void settle(StoredRequest request, UtcTime now);
  /// A key that is free again.
  void drop(RequestKey key) { dropped_.push_back(std::move(key)); }
  /// In one transaction. Errors: those of GatewayDb::save. Then what memory holds is not on disk: the process must end;
  /// but of a shared store, and of a file without room (unwritten()), memory is as before, and the request was not
  /// done. Signed heads are no request's: a shared store that does not take them keeps none waiting, and the next
  /// commit has them again.
  Status commit();
  /// Why the file could not be written last; empty: it could. Never of a shared store.
  [[nodiscard]] const std::optional<Error>& unwritten() const { return unwritten_; }
  /// Of a file that could not be written: tries it with all that waits and is owed. Errors: those of commit();
  /// unwritten() says whether it could.
  Status retry();
  /// Before each decision: takes over what others have written. The kinds that have changed.
  Result<StoreKinds> refresh();
  /// UTC that does not jump: for all that has a time to live. When it takes over a step of the machine's clock, what
  /// was kept by it moves along: commit() before the next refresh().
  struct Steady {
    UtcTime time;
    bool has_stepped = false;
  };
  Steady steady(Now now);
  /// Ends what has expired: sessions and shelves by steady time, idempotency keys. Notes how many refusals there were.
  void tick(Now now, UtcTime steady);

 private:
  Access(GatewayDb& db, std::vector<std::string> origins, AuditOrigin origin);
  void take_over(const StoredState& stored);
  StoreBatch take_batch();
  Status commit_to_file(StoreBatch batch, std::size_t own);
  void undo(const StoreBatch& refused);
  void note_own(AuditRecord record) { own_.push_back(std::move(record)); }
  void free_undone(const StoreBatch& batch);
  Status save(StoreBatch& batch);
  Status save_or_merge(StoreBatch& batch);
  Status drop_paid();
  Status merge(StoreBatch& batch);
  [[nodiscard]] Status check_decided(const StoreBatch& batch, const StoreKinds& moved) const;
  void add_to_theirs(StoreBatch& batch, const StoreKinds& moved);
  void drop_ended(StoreBatch& batch);
  void drop_answered(StoreBatch& batch);

  GatewayDb& db_;
  AuditOrigin origin_;

 public:
  Users users;
  Sessions sessions;
  Tokens tokens;
  SignInGuard guard;
  SignIn sign_in;
  RequestCheck check;
  AuditChain chain;  ///< of what is stored: a record joins it once it is written
  AuditHeads heads;
  RefusalLog refusals;
  Idempotency requests;
  ScenarioShelf scenarios;
  AlarmDesk alarms;

 private:
  SteadyTime time_;
  std::vector<AuditRecord> noted_;
  std::vector<AuditRecord> own_;  ///< what the gateway does of itself: nobody waits for these
  std::vector<AuditRecord> owed_;
  std::uint64_t owed_after_ = 0;  ///< the last record that was known when the first of them was owed
  std::vector<SignedHead> signed_;
  std::vector<StoredRequest> kept_;
  std::vector<RequestKey> dropped_;
  std::vector<MovedRequest> moved_;
  std::optional<MonotonicTime> timed_;  ///< when the steady time was stored last by itself
  bool is_time_due_ = false;
  std::optional<UtcTime> steady_;  ///< the last one
  bool has_moved_ = false;         ///< the clock has stepped since the last commit
  Held held_;
  std::optional<UtcTime> restored_from_;
  std::optional<AuditRecord> restored_;  ///< not on record yet
  std::optional<Error> unwritten_;
  bool is_stale_ = false;  ///< memory shows what is not on disk, or nothing yet
};

}  // namespace trb::gateway
