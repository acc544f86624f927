#include "services/cloud-gateway/io/access.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "common/security/keys.hpp"
#include "common/security/password_hash.hpp"

namespace trb::gateway {
namespace {

/// How much of the steady time a kill may cost; each step is a write.
constexpr Duration kTimeStep = std::chrono::minutes(1);

/// What the gateway does by itself, in the audit log.
constexpr const char* kSelf = "gateway";
constexpr const char* kUnshelve = "unshelve";
constexpr const char* kUnanswered = "unanswered";

/// Records of stops while the database is gone.
constexpr std::size_t kMostOwed = 1000;

/// Records that are read at once.
constexpr std::size_t kLookedAt = 1000;

/// So often another gateway may be quicker, before a request is told to come again.
constexpr int kTries = 5;

AuditChain chain_of(const AuditOrigin& origin, const StoredState& stored) {
  const Bytes start = audit_start(origin.fleet, stored.chain_node.empty() ? origin.node : stored.chain_node);
  return stored.last_audit ? AuditChain(start, *stored.last_audit) : AuditChain(start);
}

/// What is decided on the state that is known, and refused if that has changed; the rest is added.
constexpr std::array kDecided{StoreKind::users, StoreKind::tokens, StoreKind::scenarios};

bool has_decided(const StoreBatch& batch) {
  const StoreKinds kinds = batch.kinds();
  return std::ranges::any_of(kDecided, [&](StoreKind kind) { return kinds.contains(kind); });
}

/// Not the first row of a session, which a sign-in has made.
bool is_use(const Change<Session>& change) {
  return change.row && change.row->used != change.row->made;
}

/// Stored texts are cut; nobody does two things in one nanosecond.
bool is_same(const AuditRecord& owed, const AuditRow& row) {
  const AuditRecord& is = row.record;
  return owed.time == is.time && owed.action.starts_with(is.action) && owed.who.starts_with(is.who) &&
         owed.about.starts_with(is.about);
}

Error changed_meanwhile(StoreKind kind) {
  return fail(Errc::conflict, "another gateway has changed the " + std::string(name_of(kind)) + " at the same time",
              "look at them, and try again");
}

}  // namespace

Result<std::unique_ptr<Access>> Access::open(GatewayDb& db, std::vector<std::string> origins, AuditOrigin origin) {
  std::unique_ptr<Access> out(new Access(db, std::move(origins), std::move(origin)));
  const auto stored = db.load();
  if (!stored && !db.is_shared()) return stored.error();
  out->is_stale_ = !stored.ok();
  if (!stored) return out;
  out->restored_from_ = stored->restored;
  if (stored->steady) out->time_.restore(*stored->steady);
  out->take_over(*stored);
  return out;
}

Access::Access(GatewayDb& db, std::vector<std::string> origins, AuditOrigin origin)
    : db_(db),
      origin_(std::move(origin)),
      users(random_bytes),
      sessions(random_bytes),
      tokens(random_bytes),
      sign_in(users, sessions, guard, hash_password(new_secret(random_bytes))),
      check(std::move(origins), users, sessions, tokens),
      chain(chain_of(origin_, {})),
      scenarios(random_bytes) {}

/// Each kind as a whole, in its place: others hold references to these objects, and nobody to their rows.
void Access::take_over(const StoredState& stored) {
  const auto replace = [&](StoreKind kind, auto& object, const auto& rows) {
    if (!stored.kinds.contains(kind)) return;
    object = std::remove_reference_t<decltype(object)>(random_bytes);
    for (const auto& row : rows) object.restore(row);
  };
  replace(StoreKind::users, users, stored.users);
  replace(StoreKind::sessions, sessions, stored.sessions);
  replace(StoreKind::tokens, tokens, stored.tokens);
  replace(StoreKind::scenarios, scenarios, stored.scenarios);
  if (stored.kinds.contains(StoreKind::acknowledged)) alarms.replace(stored.acknowledged);
  if (stored.kinds.contains(StoreKind::shelves)) alarms.replace(stored.shelves);
  if (stored.kinds.contains(StoreKind::requests)) requests.replace(stored.requests);
  if (!stored.kinds.contains(StoreKind::audit)) return;
  chain = chain_of(origin_, stored);
  heads.signed_to(stored.signed_to);
}

Result<StoreKinds> Access::refresh() {
  const auto stored = is_stale_ ? db_.load() : db_.refresh();
  if (!stored) return stored.error();
  is_stale_ = false;
  take_over(*stored);
  return stored->kinds;
}

void Access::note(AuditRecord record) {
  noted_.push_back(std::move(record));
}

bool Access::may_owe_lesser() const {
  return owed_.size() < kMostOwed / 2;
}

bool Access::owe_lesser(AuditRecord record) {
  return may_owe_lesser() && owe(std::move(record));
}

bool Access::owe(AuditRecord record) {
  if (owed_.size() == kMostOwed) return false;
  if (owed_.empty()) owed_after_ = chain.number();
  owed_.push_back(std::move(record));
  return true;
}

Status Access::pay_owed() {
  if (owed_.empty()) return Done{};
  if (Status looked = drop_paid(); !looked) return looked;
  for (const AuditRecord& record : owed_) note(record);
  Status written = commit();
  if (written) owed_.clear();
  return written;
}

Status Access::drop_paid() {
  for (std::uint64_t last = owed_after_; last < chain.number() && !owed_.empty();) {
    const auto rows = db_.audit_from(last + 1, kLookedAt);
    if (!rows) return rows.error();
    if (rows->empty()) break;
    for (const AuditRow& row : *rows) std::erase_if(owed_, [&](const AuditRecord& one) { return is_same(one, row); });
    last = rows->back().record.number;
  }
  return Done{};
}

bool Access::keep(const AuditHead& head, Bytes record) {
  const auto rows = db_.audit_from(head.number, 1);
  if (!rows || rows->empty() || rows->front().record.number != head.number || rows->front().hash != head.hash.bytes)
    return false;
  heads.signed_to(head.number);
  signed_.push_back({head.number, std::move(record)});
  return true;
}

void Access::note_restored(UtcTime now) {
  if (!restored_from_) return;
  restored_ = {.time = now.ns,
               .who = "console",
               .from = "the node's own",
               .action = std::string(kAuditRestored),
               .about = "from the backup of " + to_iso8601(*restored_from_),
               .outcome = "what was recorded since is lost"};
}

void Access::settle(StoredRequest request, UtcTime now) {
  note_own({.time = now.ns,
            .who = request.key.user,
            .from = {},
            .action = kUnanswered,
            .about = request.effect,
            .outcome = "not confirmed"});
  keep(std::move(request));
}

StoreBatch Access::take_batch() {
  StoreBatch batch;
  batch.users = users.take_changes();
  batch.sessions = sessions.take_changes();
  batch.tokens = tokens.take_changes();
  batch.scenarios = scenarios.take_changes();
  batch.acknowledged = alarms.take_acknowledged();
  batch.shelves = alarms.take_shelves();
  for (AuditRecord& record : std::exchange(own_, {})) batch.audit.push_back({std::move(record), {}});
  for (AuditRecord& record : std::exchange(noted_, {})) batch.audit.push_back({std::move(record), {}});
  batch.requests = std::exchange(kept_, {});
  batch.dropped_requests = std::exchange(dropped_, {});
  batch.moved_requests = std::exchange(moved_, {});
  // With all that has a time: what is on disk must not be newer than the clock that goes on after a restart.
  if (std::exchange(is_time_due_, false) || !batch.empty()) batch.steady = steady_;
  return batch;
}

Status Access::commit() {
  const std::size_t own = own_.size();
  StoreBatch batch = take_batch();
  const bool has_heads_alone = batch.empty();
  batch.heads = std::exchange(signed_, {});
  if (batch.empty() && !restored_) return Done{};
  if (!db_.is_shared()) return commit_to_file(std::move(batch), own);
  Status saved = save_or_merge(batch);
  if (saved) return saved;
  // Of records that are stored all the same: nobody would ask for them again.
  signed_ = std::move(batch.heads);
  if (has_heads_alone) return Done{};
  if (saved.error().code == Errc::conflict) free_undone(batch);
  return saved;
}

/// `own`: so many records, the first ones, are the gateway's own. Any other error but io_error says that the file is
/// not what this process takes it for.
Status Access::commit_to_file(StoreBatch batch, std::size_t own) {
  const bool has_moved = std::exchange(has_moved_, false);
  StoreBatch all = held_.before(batch);
  all.notes_restored = restored_.has_value();
  if (restored_) all.audit.insert(all.audit.begin(), {*restored_, {}});
  Status saved = save(all);
  const bool is_full = !saved && saved.error().code == Errc::io_error;
  // What is decided is refused before, once that is known: what changes then does so of itself.
  const bool was_full = std::exchange(unwritten_, is_full ? std::optional(saved.error()) : std::nullopt).has_value();
  if (saved) held_.clear();
  if (saved) restored_.reset();
  if (!is_full) return saved;
  held_.take_from(batch, has_moved ? Held::Besides::moved : was_full ? Held::Besides::alarms : Held::Besides::nothing);
  const auto last_own = batch.audit.begin() + static_cast<std::ptrdiff_t>(own);
  std::for_each(batch.audit.begin(), last_own, [&](AuditRow& row) { owe_lesser(std::move(row.record)); });
  batch.audit.erase(batch.audit.begin(), last_own);
  batch.steady.reset();
  if (batch.empty()) return Done{};
  undo(batch);
  return saved;
}

/// Memory has what is on disk, and what waits. Sessions go with their users; all else of the batch changes no memory.
void Access::undo(const StoreBatch& refused) {
  StoreKinds kinds = refused.kinds();
  for (const StoreKind kind : {StoreKind::audit, StoreKind::requests}) kinds.erase(kind);
  if (kinds.empty()) return;
  auto stored = db_.load();
  if (!stored) return;
  stored->kinds = std::move(kinds);
  take_over(*stored);
  if (!stored->kinds.contains(StoreKind::sessions)) return;
  for (const Change<Session>& one : held_.sessions()) {
    if (one.row)
      sessions.restore(*one.row);
    else
      sessions.forget(one.key);
  }
}

Status Access::retry() {
  is_time_due_ = true;
  return owed_.empty() ? commit() : pay_owed();
}

/// What a request decided was refused, so it was not done: a repeat with its key is tried anew.
void Access::free_undone(const StoreBatch& batch) {
  if (!has_decided(batch)) return;
  StoreBatch freed;
  for (const StoredRequest& one : batch.requests) {
    if (one.answer && requests.release(one.key)) freed.dropped_requests.push_back(one.key);
  }
  if (!freed.empty()) static_cast<void>(save_or_merge(freed));
}

Status Access::save_or_merge(StoreBatch& batch) {
  if (is_stale_) return fail(Errc::peer_unreachable, "the database was not read yet", "try again in a second");
  Status saved = save(batch);
  if (saved) return saved;
  for (int i = 0; i < kTries && !saved && saved.error().code == Errc::conflict; ++i) {
    if (Status merged = merge(batch); !merged) {
      saved = merged;
      break;
    }
    saved = save(batch);
  }
  // Memory lacks what was merged, or shows what was not written.
  is_stale_ = true;
  if (saved || saved.error().code == Errc::conflict) static_cast<void>(refresh());
  return saved;
}

/// Its records follow the last stored one; the chain goes on once they are stored, so that nobody signs what is not.
Status Access::save(StoreBatch& batch) {
  AuditChain next = chain;
  for (AuditRow& row : batch.audit) row = next.append(std::move(row.record));
  Status saved = db_.save(batch);
  if (saved) chain = std::move(next);
  return saved;
}

/// Others were quicker. What only adds is added to theirs; what was decided on the old state is refused.
Status Access::merge(StoreBatch& batch) {
  const auto theirs = db_.refresh();
  if (!theirs) return theirs.error();
  take_over(*theirs);
  if (Status decided = check_decided(batch, theirs->kinds); !decided) return decided;
  add_to_theirs(batch, theirs->kinds);
  return Done{};
}

Status Access::check_decided(const StoreBatch& batch, const StoreKinds& moved) const {
  for (const StoreKind kind : kDecided) {
    if (moved.contains(kind) && batch.kinds().contains(kind)) return changed_meanwhile(kind);
  }
  for (const StoredRequest& one : batch.requests) {
    if (moved.contains(StoreKind::requests) && !one.answer && requests.find(one.key) != nullptr)
      return fail(Errc::conflict, "another gateway has received this Idempotency-Key", "repeat it with the same key");
  }
  // Nothing has moved: the tables themselves refuse it.
  if (moved.empty()) return fail(Errc::conflict, "the database refuses the change", "read again, and try again");
  return Done{};
}

void Access::add_to_theirs(StoreBatch& batch, const StoreKinds& moved) {
  // A session that was ended there is not begun anew by its use here.
  if (moved.contains(StoreKind::sessions))
    std::erase_if(batch.sessions, [&](const auto& one) { return is_use(one) && !sessions.has(one.key); });
  if (moved.contains(StoreKind::requests)) drop_answered(batch);
  if (moved.contains(StoreKind::acknowledged))
    std::erase_if(batch.acknowledged, [&](const auto& one) { return one.row && alarms.has(*one.row); });
  if (moved.contains(StoreKind::shelves)) drop_ended(batch);
}

/// The first answer stays; who was second with "not confirmed" records nothing.
void Access::drop_answered(StoreBatch& batch) {
  std::erase_if(batch.requests, [&](const StoredRequest& one) {
    const StoredRequest* known = requests.find(one.key);
    if (known == nullptr || !known->answer) return false;
    const auto row = std::find_if(batch.audit.begin(), batch.audit.end(), [&](const AuditRow& of) {
      return of.record.action == kUnanswered && of.record.who == one.key.user && of.record.about == one.effect;
    });
    if (row != batch.audit.end()) batch.audit.erase(row);
    return true;
  });
}

/// A shelf whose time is over ends at each gateway; the first of them records it.
void Access::drop_ended(StoreBatch& batch) {
  std::erase_if(batch.audit, [&](const AuditRow& row) {
    return row.record.who == kSelf && row.record.action == kUnshelve && !alarms.has_shelf(row.record.about);
  });
}

Access::Steady Access::steady(Now now) {
  steady_ = time_.at(now);
  const auto step = time_.take_step();
  if (!step) return {*steady_, false};
  has_moved_ = true;
  sessions.move(*step);
  tokens.move(*step);
  alarms.move(*step);
  for (MovedRequest& request : requests.move(*step)) moved_.push_back(std::move(request));
  return {*steady_, true};
}

void Access::tick(Now now, UtcTime steady) {
  sessions.tick(users, steady);
  alarms.tick(steady);
  for (const Shelf& one : alarms.take_ended())
    note_own({.time = now.utc.ns,
              .who = kSelf,
              .from = {},
              .action = kUnshelve,
              .about = one.source,
              .outcome = "its time is over"});
  for (AuditRecord& record : refusals.take_ended(now)) note_own(std::move(record));
  for (RequestKey& key : requests.take_expired(steady)) drop(std::move(key));
  if (timed_ && now.mono - *timed_ < kTimeStep) return;
  timed_ = now.mono;
  is_time_due_ = true;
}

}  // namespace trb::gateway
