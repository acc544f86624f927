// Hello each way, proven by certificate and key. If a pair of nodes has two links, one stays.
#pragma once

#include <optional>
#include <string>

#include "services/router/core/admission.hpp"
#include "services/router/core/links.hpp"
#include "services/router/core/local_profile.hpp"
#include "services/router/core/shared_keys.hpp"
#include "services/router/core/trust_store.hpp"

namespace trb::router {

/// A link carries its peer's messages from now on.
struct Carried {
  LinkId link = 0;
  Hello hello;
  bool again = false;        ///< the same process of the peer, which nobody has missed yet
  bool new_address = false;  ///< it is at another address than before, or was reached at this one
};

/// link     | event                                              | next
/// ---------|----------------------------------------------------|-------------------------------------------------
/// dialled  | connected                                          | dialled; this node's Hello is sent
/// dialled  | a Hello that proves its sender                     | carries, or loses to a better link
/// dialled  | a Hello that does not (invalid)                    | -, a link error
/// -        | a member's Hello                                   | accepted: up, this node's Hello is sent
/// -        | a stranger's, or a wrong one (invalid)              | refused by name, its key is denied
/// accepted | no other link to its peer is up or being dialled   | carries
/// accepted | another link is                                    | waits for one more message; the better link stays
/// any      | a second Hello (repeated)                          | as before, counted
class Handshake {
 public:
  Handshake(const LocalNode& node, PeerTable& table, Admission& admission, TrustStore& trust, OwnMessages& messages,
            SealBook& seals, Links& links, LinkErrors& errors, LocalProfile& profile)
      : node_(node),
        table_(table),
        admission_(admission),
        trust_(trust),
        messages_(messages),
        seals_(seals),
        links_(links),
        errors_(errors),
        profile_(profile) {}

  void on_dial_connected(LinkId link, Now now, Effects& out);
  /// `key`: of the connection.
  std::optional<Carried> on_hello(LinkId link, BytesView key, const Message& message, std::uint64_t sequence, Now now,
                                  Effects& out);
  /// The link of an accepted Hello carries messages, unless there is a better link: then it is dropped.
  std::optional<Carried> carry(Link& link, const Hello& hello, Now now, Effects& out);

  /// What arrived on a connection, or on this dialled link, has another version of the wire: its node is refused by
  /// name, and gets the reason in the version that it reads.
  void on_other_version(LinkId link, BytesView key, std::uint8_t version, const HeaderView& header, Now now,
                        Effects& out);
  /// The first message of a connection is not valid: it is answered by a Goodbye.
  void refuse(LinkId link, BytesView key, const Error& error, Now now, Effects& out);
  /// The last word to the connection whose message is being handled; it has no link.
  void send(LinkId link, const Body& body, Effects& out, std::uint8_t version = kWireVersion);

 private:
  void send_hello(Link& link, Now now, Effects& out);
  [[nodiscard]] static Result<Hello> read(LinkId link, const Message& message);
  Result<Certificate> check(const Link& link, const Message& message, const Hello& hello, Now now, Effects& out);
  [[nodiscard]] Status check_claims(const Link& link, const Message& message, const Hello& hello,
                                    const Certificate& certificate) const;
  [[nodiscard]] Status check_known(const Link& link, const Hello& hello, const Certificate& certificate) const;
  [[nodiscard]] bool proves_name(const Link& link, const Message& message, const Hello& hello) const;
  [[nodiscard]] std::string name_of_other(BytesView key, const HeaderView& header);
  bool may_send_hello(LinkId link, BytesView key, Now now, Effects& out);
  void refuse_dialled(Link& link, const Message& message, const Result<Hello>& hello, const Error& why, Now now,
                      Effects& out);
  void refuse_accepted(const Link& link, const Message& message, const Result<Hello>& hello, const Error& why, Now now,
                       Effects& out);
  std::optional<Carried> link_up(Link& link, const Certificate& certificate, const Hello& hello, Now now, Effects& out);
  [[nodiscard]] bool is_in_doubt(const Link& link, const Peer& peer) const;
  bool settle_double(const Link& link, Peer& peer, Now now, Effects& out);
  void note(const Link& link, Peer& peer, const Hello& hello, Now now, Effects& out);
  void look_for_older(const Link& link, const Hello& hello, const Certificate& certificate, Now now, Effects& out);
  void tell_shared(const Certificate& certificate, const NodeStart& one, const NodeStart& other, Now now, Effects& out);

  const LocalNode& node_;
  PeerTable& table_;
  Admission& admission_;
  TrustStore& trust_;
  OwnMessages& messages_;
  SealBook& seals_;
  Links& links_;
  LinkErrors& errors_;
  LocalProfile& profile_;
  SharedKeys shared_;
};

}  // namespace trb::router
