// What the authority has signed: who is revoked, whose certificate was renewed, who is a member.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/security/keys.hpp"
#include "common/security/revocations.hpp"
#include "proto/bodies/bus.hpp"
#include "services/router/core/link_errors.hpp"
#include "services/router/core/local_node.hpp"
#include "services/router/core/peer_table.hpp"

namespace trb::router {

/// What was new in a trust update, and why part of it was refused.
struct TakenUpdate {
  TrustUpdate fresh;
  bool known = false;                        ///< part of it was known already
  bool own_renewed = false;                  ///< this node has another certificate now
  std::vector<std::string> relay_changed{};  ///< who may relay now and might not before, or the reverse; also this node
  bool must_be_told = false;                 ///< of a list, or a clock: reported even if other parts were known or new
  std::optional<Error> refusal;              ///< the first
  [[nodiscard]] bool is_empty() const { return fresh.revocations.kind.empty() && fresh.certificates.empty(); }
};

/// certificate   | event                                            | next
/// --------------|--------------------------------------------------|-----------------------------------------------
/// -             | an update brings it; it is signed, in date, new  | kept (`renewed`) until its owner shows it
/// kept          | its owner's Hello has it, or a newer one         | -
/// kept          | it ends, by a steady clock (expired)             | -
/// kept          | a list revokes it                                | -; its key is remembered
/// any           | a newer one with another right to relay          | kept; its owner's links end, and are made anew
/// any           | an older one of the same node (invalid)          | downgraded
/// any           | a forged one, of another fleet (invalid)         | bad_signature, foreign_fleet
///
/// list          | a higher number                                  | in force, whatever the clock says
/// list          | one that lacks who is revoked, and has not ended | that stays revoked, also after a restart
/// list          | a lower number, or a second list of one (invalid)| downgraded, conflict
class TrustStore {
 public:
  TrustStore(LocalNode& node, PeerTable& table, LinkErrors& errors) : node_(node), table_(table), errors_(errors) {}

  /// What the last start had to know beside its list; before anything is taken.
  void restore_dropped(std::vector<Revocation> dropped);

  /// Takes what is new. `checks`: how many signatures the sender may cause to be checked; nullptr: any number.
  TakenUpdate take(const TrustUpdate& update, Budget* checks, Now now, Effects& out);

  /// The certificate in this record, if its holder is a member now. Errors: those of the signature, cert_revoked,
  /// cert_not_yet_valid, cert_expired. `holder`: whose certificate it claims to be (not trusted): if it
  /// is the record that is held of that node already, it need not be decoded.
  Result<Certificate> open_member(const SignedRecord& record, Now now, Effects& out, std::string_view holder = {});
  /// Errors: downgraded: a newer certificate of the same node is known.
  [[nodiscard]] Status check_newest(const Certificate& certificate) const;
  /// Is this exactly the record that is held already? Its signature was checked.
  [[nodiscard]] bool is_known(const SignedRecord& record) const;
  /// nullptr: not revoked.
  [[nodiscard]] const Revocation* find_revoked(const Certificate& certificate) const {
    return find_revocation(list_, certificate);
  }
  [[nodiscard]] const Revocation* own_revocation() const { return find_revoked(node_.config().own); }
  /// Who is revoked, and up to which certificate; but for those of whom this node knows one that is not.
  [[nodiscard]] RevokedNodes revoked_nodes() const;
  [[nodiscard]] std::uint64_t list_number() const { return list_.number; }

  /// Keeps the key of a certificate that is revoked, as far as this node has met it: unless a member has that key.
  void remember_revoked(const Certificate& certificate);
  /// A connection with this key has presented a revoked certificate. The key is kept if the certificate names it:
  /// anybody can present another's.
  void remember_presented(const SignedRecord& revoked, BytesView key);
  [[nodiscard]] bool is_revoked_key(BytesView key) const { return revoked_keys_.count(key) != 0; }
  /// A connection has this key. True: it is revoked; counted and logged.
  bool refuse_revoked_key(BytesView key, Now now, Effects& out);
  /// A new list is in force: drops the certificates that it revokes, and the keys that it no longer revokes.
  void drop_revoked();

  /// Everything that must be on disk.
  [[nodiscard]] TrustUpdate all() const;
  [[nodiscard]] StoreUpdate to_store(Effects& out) const;
  /// What a peer whose list has this number needs to know; may be empty.
  [[nodiscard]] TrustUpdate for_peer(std::uint64_t known_list, Now now) const;
  /// What a refused node needs to come back: its renewed certificate, or the list that revokes it.
  [[nodiscard]] std::optional<TrustUpdate> for_refused(const Error& refusal, const Hello& hello) const;
  /// Its owner has presented this certificate itself.
  void forget_shown(const Certificate& certificate);
  void forget_ended(Now now);

 private:
  [[nodiscard]] Result<Certificate> open_known(const SignedRecord& record, std::string_view holder) const;
  void take_certificates(const TrustUpdate& update, Budget* checks, Now now, TakenUpdate& taken, Effects& out);
  Status take_list(const SignedRecord& record, Now now, Effects& out);
  void keep_dropped(RevocationList& next, Now now, Effects& out);
  Status take_certificate(const SignedRecord& record, Now now, TakenUpdate& taken, Effects& out);
  [[nodiscard]] Status check_own(const Certificate& certificate) const;
  Status keep(const SignedRecord& record, const Certificate& certificate, TakenUpdate& taken);
  [[nodiscard]] bool has_ended(const SignedRecord& renewal, Now now) const;

  LocalNode& node_;
  PeerTable& table_;
  LinkErrors& errors_;
  SignedRecord record_;                          ///< the newest list; its kind is empty if there is none
  RevocationList list_;                          ///< its content, and what it dropped too early
  std::vector<Revocation> dropped_;              ///< of these what it dropped
  std::map<std::string, SignedRecord> renewed_;  ///< of others, by id: newer than what they present themselves
  std::map<Bytes, Certificate, std::less<>> revoked_keys_;
};

}  // namespace trb::router
