#include "services/router/core/trust_store.hpp"

#include <algorithm>

#include "common/base/hex.hpp"
#include "proto/body.hpp"

namespace trb::router {

void TrustStore::restore_dropped(std::vector<Revocation> dropped) {
  dropped_ = std::move(dropped);
  list_.revoked = dropped_;
}

TakenUpdate TrustStore::take(const TrustUpdate& update, Budget* checks, Now now, Effects& out) {
  TakenUpdate taken;
  const bool lists = !update.revocations.kind.empty() && update.revocations != record_;
  taken.known = !update.revocations.kind.empty() && !lists;
  // Checking a signature takes 50 us: one member may cause only so many checks per second.
  if (lists && (checks == nullptr || checks->take(now.mono))) {
    if (Status good = take_list(update.revocations, now, out); good) {
      taken.fresh.revocations = update.revocations;
    } else {
      taken.refusal = good.error();
    }
  }
  taken.must_be_told = taken.refusal.has_value();
  take_certificates(update, checks, now, taken, out);
  return taken;
}

void TrustStore::take_certificates(const TrustUpdate& update, Budget* checks, Now now, TakenUpdate& taken,
                                   Effects& out) {
  for (const SignedRecord& record : update.certificates) {
    if (is_known(record)) {
      taken.known = true;
      continue;
    }
    if (checks != nullptr && !checks->take(now.mono)) {
      taken.refusal = fail(Errc::queue_full, "over " + std::to_string(kUpdatesChecked) + " signatures in a second");
      return;
    }
    const Status good = take_certificate(record, now, taken, out);
    if (good) taken.fresh.certificates.push_back(record);
    taken.own_renewed = taken.own_renewed || (good && record == node_.config().certificate);
    const bool ahead = !good && good.error().code == Errc::cert_not_yet_valid;
    if (!good && (!taken.refusal || (ahead && !taken.must_be_told))) taken.refusal = good.error();
    // Whoever has renewed it with a clock that is ahead would take "nothing new" for good news.
    taken.must_be_told = taken.must_be_told || ahead;
    // A sender of one forged certificate sends more: a message of 256 would cost as many checks.
    if (taken.refusal && taken.refusal->code == Errc::bad_signature) return;
  }
}

/// Is this exactly the record that is held already? Its signature was checked.
bool TrustStore::is_known(const SignedRecord& record) const {
  if (record == node_.config().certificate) return true;
  const auto shown = decode<Certificate>(record.payload.bytes);
  if (!shown) return false;
  const auto peer = table_.peers().find(shown->id);
  if (peer != table_.peers().end() && record == peer->second.certificate_record) return true;
  const auto renewed = renewed_.find(shown->id);
  return renewed != renewed_.end() && record == renewed->second;
}

Status TrustStore::take_list(const SignedRecord& record, Now now, Effects& out) {
  auto list = open_revocations(record, node_.config().authority);
  if (!list) return list.error();
  if (list->number < std::max<std::uint64_t>(list_.number, 1)) {
    return fail(
        Errc::downgraded,
        "revocation list " + std::to_string(list->number) + "; list " + std::to_string(list_.number) + " is in force",
        "bring news.json as it is now in the authority's folder");
  }
  if (list->number == list_.number) {
    return fail(Errc::conflict, "another revocation list with number " + std::to_string(list->number),
                "the authority's folder was put back to an older copy: trb fleet revoke once more, with --via NODE_DIR "
                "of a node that is up, so that the next list has what both have");
  }
  // A list is accepted whatever the clock says: a list can only take rights away.
  if (node_.checked_utc(now.utc) != now.utc) node_.raise_utc_bound({list->issued}, out);
  out.log(LogLevel::warning, "revocations",
          "list " + std::to_string(list->number) + " of " + to_iso8601({list->issued}) + ": " +
              std::to_string(list->revoked.size()) + " revoked, beacon key " + std::to_string(list->beacon_number));
  out.count("news.lists");
  keep_dropped(*list, now, out);
  record_ = record;
  list_ = std::move(*list);
  return Done{};
}

/// A list leaves out who is revoked once that certificate has ended everywhere. One that does so earlier was signed in
/// an older copy of the authority's folder, or by a wrong clock. To refuse it would shut this node out of the fleet:
/// the next beacon key comes with it.
void TrustStore::keep_dropped(RevocationList& next, Now now, Effects& out) {
  constexpr std::size_t kMost = 2000;  // as many as a list may have
  const UtcTime utc = node_.checked_utc(now.utc);
  const auto has_ended = [&](const Revocation& entry) { return entry.until != 0 && entry.until <= utc.ns; };
  const auto is_early = [&](const Revocation& entry) { return entry.until > utc.ns; };
  dropped_ = not_revoked_by(next, list_.revoked);
  // What an earlier start kept is forgotten by no clock that may be wrong at this one.
  if (list_.number != 0) std::erase_if(dropped_, has_ended);
  std::stable_partition(dropped_.begin(), dropped_.end(), is_early);
  dropped_.resize(std::min(dropped_.size(), kMost - std::min(kMost, next.revoked.size())));
  next.revoked.insert(next.revoked.end(), dropped_.begin(), dropped_.end());
  const auto early = std::count_if(dropped_.begin(), dropped_.end(), is_early);
  // Who may have ended, as the list does not say, is kept all the same: that costs nothing, and is nobody's mistake.
  if (early == 0) return;
  out.count("news.dropped");
  out.log(LogLevel::warning, "revocations_dropped",
          "list " + std::to_string(next.number) + " lacks '" + dropped_.front().id + "' (serial " +
              std::to_string(dropped_.front().serial) + "), one of " + std::to_string(early) +
              " that are revoked and have not ended; here they stay revoked: trb fleet revoke "
              "FLEET_DIR " +
              dropped_.front().id + " --via NODE_DIR, in the folder that revoked it");
}

Status TrustStore::take_certificate(const SignedRecord& record, Now now, TakenUpdate& taken, Effects& out) {
  auto certificate = open_member(record, now, out);
  if (!certificate) return certificate.error();
  const bool own = certificate->id == node_.id();
  if (Status newest = check_newest(*certificate); !newest) return newest.error();
  if (Status good = own ? check_own(*certificate) : Status(Done{}); !good) return good;
  out.count("news.certificates");
  if (!own) return keep(record, *certificate, taken);
  if (certificate->relay != node_.config().own.relay) taken.relay_changed.push_back(certificate->id);
  node_.renew(record, *certificate);
  out.log(LogLevel::info, "certificate_renewed",
          "serial " + std::to_string(certificate->serial) + ", to " + to_iso8601({certificate->not_after}));
  out.add(StoreCertificate{record});
  return Done{};
}

/// A certificate of this node must fit what runs here.
Status TrustStore::check_own(const Certificate& certificate) const {
  const RouterConfig& config = node_.config();
  if (certificate.identity_key != config.own.identity_key || certificate.link_key != config.own.link_key) {
    return fail(Errc::wrong_key, "a certificate of '" + config.id + "' for other keys than this node's",
                "have this node's own request signed: trb fleet request, trb fleet sign");
  }
  if (certificate.role == config.role) return Done{};
  // The services were started for the other role, and the next start would compare it with node.json.
  return fail(Errc::bad_value,
              "a certificate of '" + config.id + "' with the role " + std::string(name_of(certificate.role)) +
                  "; it runs as " + std::string(name_of(config.role)),
              "set role in node.json, put that certificate.json into keys/ and run trb reload");
}

Status TrustStore::keep(const SignedRecord& record, const Certificate& certificate, TakenUpdate& taken) {
  if (renewed_.size() >= kMaxPeers && renewed_.count(certificate.id) == 0)
    return fail(Errc::queue_full, "no room for another node's renewed certificate", std::string(kFullCure));
  renewed_[certificate.id] = record;
  // A link stays up through a renewal: the keys are the same, the end is later.
  Peer* peer = table_.find(certificate.id);
  const bool same = peer != nullptr && peer->certificate.identity_key == certificate.identity_key &&
                    peer->certificate.link_key == certificate.link_key;
  if (same) {
    if (peer->certificate.relay != certificate.relay) taken.relay_changed.push_back(certificate.id);
    peer->certificate = certificate;
    peer->certificate_record = record;
  }
  return Done{};
}

Result<Certificate> TrustStore::open_known(const SignedRecord& record, std::string_view holder) const {
  // Every beacon, Hello and relay presents it again: the signature of a peer's own record was already checked.
  const PeerTable& table = table_;
  const Peer* said = table.find(holder);
  if (said != nullptr && said->certificate_record == record) return said->certificate;
  const auto shown = decode<Certificate>(record.payload.bytes);
  const Peer* peer = shown ? table.find(shown->id) : nullptr;
  if (peer != nullptr && peer->certificate_record == record) return peer->certificate;
  return open_certificate_any_time(record, node_.config().authority);
}

Result<Certificate> TrustStore::open_member(const SignedRecord& record, Now now, Effects& out,
                                            std::string_view holder) {
  auto certificate = open_known(record, holder);
  if (!certificate) return certificate;
  if (const Revocation* entry = find_revoked(*certificate)) {
    return fail(Errc::cert_revoked,
                "certificate of '" + certificate->id + "' (serial " + std::to_string(certificate->serial) +
                    ") is revoked by list " + std::to_string(list_.number) + ": " + entry->reason,
                "if it shall be a member again: new keys, trb fleet request and trb fleet sign");
  }
  // This clock is known to be behind: what the authority has signed knows the time better.
  const bool verified = node_.checked_utc(now.utc) == now.utc;
  if (!verified) node_.raise_utc_bound({certificate->not_before}, out);
  if (Status dates = check_dates(*certificate, node_.checked_utc(now.utc)); !dates) return dates.error();
  return certificate;
}

Status TrustStore::check_newest(const Certificate& certificate) const {
  std::uint64_t newest = certificate.id == node_.id() ? node_.config().own.serial : 0;
  if (const auto peer = table_.peers().find(certificate.id); peer != table_.peers().end())
    newest = peer->second.certificate.serial;
  if (const auto at = renewed_.find(certificate.id); at != renewed_.end()) {
    if (const auto renewed = decode<Certificate>(at->second.payload.bytes)) newest = std::max(newest, renewed->serial);
  }
  if (certificate.serial >= newest) return Done{};
  return fail(Errc::downgraded,
              "an older certificate of '" + certificate.id + "': serial " + std::to_string(certificate.serial) + ", " +
                  std::to_string(newest) + " is known",
              "use the one that was signed last");
}

void TrustStore::remember_revoked(const Certificate& certificate) {
  const Peer* holder = table_.by_key(certificate.link_key.bytes);
  if (holder != nullptr && holder->id != certificate.id && find_revoked(holder->certificate) == nullptr) return;
  if (revoked_keys_.size() < kMaxPeers) revoked_keys_[certificate.link_key.bytes] = certificate;
}

void TrustStore::remember_presented(const SignedRecord& revoked, BytesView key) {
  const auto certificate = decode<Certificate>(revoked.payload.bytes);
  if (certificate && certificate->link_key.bytes == key) remember_revoked(*certificate);
}

bool TrustStore::refuse_revoked_key(BytesView key, Now now, Effects& out) {
  const auto at = revoked_keys_.find(key);
  if (at == revoked_keys_.end()) return false;
  const Revocation* entry = find_revoked(at->second);
  errors_.note(at->second.id, "", "cert_revoked",
               "its key has knocked since: " + (entry == nullptr ? std::string("revoked") : entry->reason), now);
  out.count("refused.cert_revoked");
  out.log(LogLevel::warning, "revoked_key", "the revoked key of '" + at->second.id + "' knocked: " + to_hex(key));
  return true;
}

void TrustStore::drop_revoked() {
  std::erase_if(revoked_keys_, [&](const auto& row) { return find_revoked(row.second) == nullptr; });
  std::erase_if(renewed_, [&](const auto& row) {
    const auto certificate = decode<Certificate>(row.second.payload.bytes);
    return !certificate || find_revoked(*certificate) != nullptr;
  });
}

RevokedNodes TrustStore::revoked_nodes() const {
  std::map<std::string, std::uint64_t> serials;
  for (const Revocation& entry : list_.revoked) {
    const auto peer = table_.peers().find(entry.id);
    const bool is_member = peer != table_.peers().end() && find_revoked(peer->second.certificate) == nullptr;
    const bool is_own = entry.id == node_.id() && own_revocation() == nullptr;
    if (is_member || is_own || renewed_.contains(entry.id)) continue;
    std::uint64_t& serial = serials[entry.id];
    serial = std::max(serial, entry.serial);
  }
  RevokedNodes out;
  for (const auto& [id, serial] : serials) out.nodes.push_back({id, serial});
  return out;
}

TrustUpdate TrustStore::all() const {
  TrustUpdate update{record_, {}};
  for (const auto& [id, record] : renewed_) {
    constexpr std::size_t kMost = 256;
    if (update.certificates.size() < kMost) update.certificates.push_back(record);
  }
  return update;
}

StoreUpdate TrustStore::to_store(Effects& out) const {
  StoreUpdate store{all(), list_.beacon_number, {}, dropped_};
  for (const SealedKey& sealed : list_.beacon_keys) {
    if (sealed.id == node_.id()) store.beacon_box = sealed.box.bytes;
  }
  const bool staying = !record_.kind.empty() && own_revocation() == nullptr;
  if (staying && store.beacon_box.empty()) {
    out.log(LogLevel::warning, "no_beacon_key",
            "list " + std::to_string(list_.number) + " has no beacon key for this node: trb fleet sign it again");
  }
  return store;
}

TrustUpdate TrustStore::for_peer(std::uint64_t known_list, Now now) const {
  TrustUpdate update = all();
  std::erase_if(update.certificates, [&](const SignedRecord& record) { return has_ended(record, now); });
  if (list_.number <= known_list) update.revocations = {};
  return update;
}

std::optional<TrustUpdate> TrustStore::for_refused(const Error& refusal, const Hello& hello) const {
  if (refusal.code == Errc::cert_revoked) {
    // The node may not know the list yet. One whose Hello names it does not get it again.
    return hello.revocations < list_.number ? std::optional(TrustUpdate{record_, {}}) : std::nullopt;
  }
  if (refusal.code != Errc::downgraded && refusal.code != Errc::cert_expired) return std::nullopt;
  const auto shown = decode<Certificate>(hello.certificate.payload.bytes);
  if (!shown) return std::nullopt;
  const auto peer = table_.peers().find(shown->id);
  const auto renewed = renewed_.find(shown->id);
  if (renewed != renewed_.end()) return TrustUpdate{{}, {renewed->second}};
  if (peer != table_.peers().end() && peer->second.certificate.serial > shown->serial)
    return TrustUpdate{{}, {peer->second.certificate_record}};
  return std::nullopt;
}

bool TrustStore::has_ended(const SignedRecord& renewal, Now now) const {
  const auto renewed = decode<Certificate>(renewal.payload.bytes);
  return !renewed || renewed->not_after <= node_.checked_utc(now.utc).ns;
}

void TrustStore::forget_ended(Now now) {
  // A clock that is far ahead for a moment would show all as ended.
  if (node_.clock_is_steady(now)) std::erase_if(renewed_, [&](const auto& row) { return has_ended(row.second, now); });
}

void TrustStore::forget_shown(const Certificate& certificate) {
  const auto at = renewed_.find(certificate.id);
  if (at == renewed_.end()) return;
  const auto renewed = decode<Certificate>(at->second.payload.bytes);
  if (!renewed || renewed->serial <= certificate.serial) renewed_.erase(at);
}

}  // namespace trb::router
