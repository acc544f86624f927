// What this node knows of its authority's signatures: who is revoked, whose certificate was renewed, who is a member.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/security/keys.hpp"
#include "common/security/revocations.hpp"
#include "services/router/core/link_errors.hpp"
#include "services/router/core/local_node.hpp"
#include "services/router/core/peer_table.hpp"

namespace trb::router {

/// What of a trust update was new, and why something of it was refused.
struct TakenUpdate {
  TrustUpdate fresh;
  bool known = false;            ///< something of it was held already
  bool own_renewed = false;      ///< this node has another certificate now
  bool list_refused = false;     ///< what else is known or new must not hide that
  std::optional<Error> refusal;  ///< the first
  [[nodiscard]] bool is_empty() const { return fresh.revocations.kind.empty() && fresh.certificates.empty(); }
};

/// certificate   | event                                            | next
/// --------------|--------------------------------------------------|-----------------------------------------------
/// -             | an update brings it; it is signed, in date, new  | kept (`renewed`) until its owner shows it
/// kept          | its owner's Hello has it, or a newer one         | -
/// kept          | it ends, by a steady clock (expired)             | -
/// kept          | a list revokes it                                | -; its key is remembered
/// any           | an older one of the same node (invalid)          | downgraded
/// any           | a forged one, of another fleet (invalid)         | bad_signature, foreign_fleet
///
/// list          | a higher number                                  | in force, whatever the clock says
/// list          | a lower number, another of this one (invalid)    | downgraded, conflict
class TrustStore {
 public:
  TrustStore(LocalNode& node, PeerTable& table, LinkErrors& errors) : node_(node), table_(table), errors_(errors) {}

  /// Takes what is new. `checks`: how many signatures whoever brought it may have checked; nullptr: any number.
  TakenUpdate take(const TrustUpdate& update, Budget* checks, Now now, Effects& out);

  /// The certificate in this record, if its holder is a member now. Errors: of the signature, cert_revoked,
  /// cert_not_yet_valid, cert_expired.
  Result<Certificate> open_member(const SignedRecord& record, Now now, Effects& out);
  /// Errors: downgraded; a newer one of the same node is known.
  [[nodiscard]] Status check_newest(const Certificate& certificate) const;
  /// The very record that is held already; its signature was checked.
  [[nodiscard]] bool is_known(const SignedRecord& record) const;
  /// nullptr: not on the list.
  [[nodiscard]] const Revocation* find_revoked(const Certificate& certificate) const {
    return find_revocation(list_, certificate);
  }
  [[nodiscard]] const Revocation* own_revocation() const { return find_revoked(node_.config().own); }
  [[nodiscard]] std::uint64_t list_number() const { return list_.number; }

  /// The key of a certificate that is revoked, as far as it was met.
  void remember_revoked(const Certificate& certificate);
  [[nodiscard]] bool is_revoked_key(BytesView key) const { return revoked_keys_.count(key) != 0; }
  /// A connection has this key. True: it is revoked; counted and logged.
  bool refuse_revoked_key(BytesView key, Now now, Effects& out);
  /// A new list is in force: what it revokes is not kept any more, nor the keys that it does not revoke.
  void drop_revoked();

  /// All that is to be on disk.
  [[nodiscard]] TrustUpdate all() const;
  [[nodiscard]] StoreUpdate to_store(Effects& out) const;
  /// What a peer whose list has this number has to know; may be empty.
  [[nodiscard]] TrustUpdate for_peer(std::uint64_t known_list, Now now) const;
  /// What a refused node has to know to come back: its renewed certificate, or the list that it is on.
  [[nodiscard]] std::optional<TrustUpdate> for_refused(const Error& refusal, const Hello& hello) const;
  /// Its owner has shown this one itself.
  void forget_shown(const Certificate& certificate);
  void forget_ended(Now now);

 private:
  [[nodiscard]] Result<Certificate> open_known(const SignedRecord& record) const;
  void take_certificates(const TrustUpdate& update, Budget* checks, Now now, TakenUpdate& taken, Effects& out);
  Status take_list(const SignedRecord& record, Now now, Effects& out);
  Status take_certificate(const SignedRecord& record, Now now, Effects& out);
  [[nodiscard]] Status check_own(const Certificate& certificate) const;
  Status keep(const SignedRecord& record, const Certificate& certificate);
  [[nodiscard]] bool has_ended(const SignedRecord& renewal, Now now) const;

  LocalNode& node_;
  PeerTable& table_;
  LinkErrors& errors_;
  SignedRecord record_;  ///< the newest list; an empty kind for none
  RevocationList list_;
  std::map<std::string, SignedRecord> renewed_;  ///< of others, by id: newer than what they say themselves
  std::map<Bytes, Certificate, std::less<>> revoked_keys_;
};

}  // namespace trb::router
