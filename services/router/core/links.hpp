// Links: dialled, kept alive, dropped and dialled again; and the leases of peers, which run while they have no link.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "services/router/core/link_end_reason.hpp"
#include "services/router/core/link_errors.hpp"
#include "services/router/core/local_bus.hpp"
#include "services/router/core/own_messages.hpp"
#include "services/router/core/peer_table.hpp"
#include "services/router/core/seal_book.hpp"
#include "services/router/core/trust_store.hpp"

namespace trb::router {

/// Handles peers that have lost their link: a relay may reach them.
class LinkWatcher {
 public:
  LinkWatcher() = default;
  LinkWatcher(const LinkWatcher&) = delete;
  LinkWatcher& operator=(const LinkWatcher&) = delete;
  /// The link that carried this peer's messages is gone.
  virtual void on_link_lost(Peer& peer, const Link& gone, Now now, Effects& out) = 0;
  /// A relay reaches it: a link is less urgent.
  [[nodiscard]] virtual bool is_relayed(const Peer& peer) const = 0;

 protected:
  ~LinkWatcher() = default;
};

/// link    | event                                              | next
/// --------|----------------------------------------------------|--------------------------------------------------
/// -       | a seed or peer is due, and no link to it           | dialled
/// dialled | 2 s without its Hello (expired), or it ends        | -; dialled again, 0.2 s to 2 s later
/// dialled | Hello (Handshake)                                  | up
/// up      | keep-alive is due                                  | up; sealed, then sent
/// up      | nothing received, or not confirmed, for a lease    | -; the peer's lease runs from its last sign of life
/// up      | a gap in the sequence, a wrong seal (invalid)      | -
/// up      | its certificate ends (expired)                     | -
/// any     | parts of a message without end (invalid)           | -; its peer stays out for 10 s
///
/// peer    | its link is gone                                   | lost
/// lost    | a link is up                                       | met
/// lost    | a lease (expired)                                  | expired: peer_expired to the services
class Links {
 public:
  Links(const LocalNode& node, PeerTable& table, OwnMessages& messages, SealBook& seals, LinkErrors& errors,
        LocalBus& bus, const TrustStore& trust, LinkWatcher& watcher)
      : node_(node),
        table_(table),
        messages_(messages),
        seals_(seals),
        errors_(errors),
        bus_(bus),
        trust_(trust),
        watcher_(watcher) {}

  /// Seeds are dialled from now on.
  void start(Now now);
  /// Nothing can be reached by this node's old address any more: every link ends.
  void drop_all(const std::string& why, Now now, Effects& out);
  /// Dials everybody at once, also peers with a smaller id.
  void redial_all(Now now);
  /// This node is a member again: dials seeds, and peers without a link.
  void redial_unlinked(Now now);

  /// Ends the link here. With `send_goodbye` the other side is notified, if possible.
  void drop(LinkId link, const std::string& why, bool send_goodbye, Now now, Effects& out);
  void on_ended(LinkId link, LinkEndReason how, Now now, Effects& out);
  /// The frame that arrived on this link, or on a connection without one (0), cannot be decoded: it would be missing in
  /// the link's sequence.
  void on_bad_frame(LinkId link, const Error& error, Now now, Effects& out);
  /// A connection that carries this link names another one. One connection is one link: it ends.
  void on_second_link(LinkId link, Now now, Effects& out);
  /// Parts of a message came by it without end, which no bound of libzmq's stops. Its key stays out for a while.
  void on_incomplete(LinkId link, Now now, Effects& out);
  /// A seal of this link is missing or wrong: an alarm.
  void break_seal(LinkId link, const std::string& peer, SealFault fault, Now now, Effects& out);

  /// A seed's host name was found: this link is dialled at this numeric address.
  void on_name_found(LinkId link, const std::string& address);
  /// The name is not known, or not yet: the dial ends as failed. `why` is for people; empty: nothing to report yet.
  void on_name_unknown(LinkId link, const std::string& why, Now now, Effects& out);

  /// A frame arrived on this link. False: it is out of sequence, and the link is over.
  bool receive(Link& link, const HeaderView& header, Now now, Effects& out);
  static void on_keep_alive(Link& link, const KeepAlive& body, Now now);

  /// The peer has a new address: a dial to the old one ends.
  void set_address(Peer& peer, const std::string& address, Now now, Effects& out);
  void redial_later(Redial& redial, Now now, Duration at_least = {});
  /// It is dialled soon, by this node or by the peer: the smaller id goes first.
  void redial_soon(Peer& peer, Now now);
  /// Notifies the services that the peer is gone.
  void expire(Peer& peer, const std::string& reason, Effects& out);

  /// With `may_dial` false nothing is dialled: this node is not a member.
  void tick(bool may_dial, Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  struct Lapse {
    LinkId link;
    std::string_view code;
    std::string why;
  };
  struct Dialled {
    const std::string& address;
    BytesView key;
    std::string_view peer;  ///< empty: a seed
  };
  void dial(Redial& redial, const Dialled& whom, Now now, Effects& out);
  void dial_peer(Peer& peer, bool may_dial, Now now, Effects& out);
  void dial_seed(Seed& seed, bool may_dial, Now now, Effects& out);
  void redial_failed(const Link& gone, Now now);
  void keep_out(BytesView key, Now now);
  void lose(Peer& peer, const Link& gone, Now now, Effects& out);
  [[nodiscard]] std::optional<Lapse> lapse_of(const Link& link, Now now) const;
  void keep_alive(Link& link, Now now, Effects& out);
  void tick_links(Now now, Effects& out);
  void tick_peers(bool may_dial, Now now, Effects& out);

  const LocalNode& node_;
  PeerTable& table_;
  OwnMessages& messages_;
  SealBook& seals_;
  LinkErrors& errors_;
  LocalBus& bus_;
  const TrustStore& trust_;
  LinkWatcher& watcher_;
};

}  // namespace trb::router
