// Links: dialled, kept alive, dropped and dialled again; and the peers' leases, which run while they have none.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "services/router/core/link_end.hpp"
#include "services/router/core/link_errors.hpp"
#include "services/router/core/local_bus.hpp"
#include "services/router/core/own_messages.hpp"
#include "services/router/core/peer_table.hpp"
#include "services/router/core/seal_book.hpp"
#include "services/router/core/trust_store.hpp"

namespace trb::router {

/// Who cares for the peers that have lost their link: they may be reached by a relay.
class LinkWatcher {
 public:
  LinkWatcher() = default;
  LinkWatcher(const LinkWatcher&) = delete;
  LinkWatcher& operator=(const LinkWatcher&) = delete;
  /// The link that carried this peer's messages is gone.
  virtual void on_link_lost(Peer& peer, const Link& gone, Now now, Effects& out) = 0;
  /// A relay reaches it: a link is wanted with less hurry.
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
/// up      | nothing heard, or not confirmed, for a lease       | -; the peer's lease runs from the last sign of it
/// up      | a gap in the sequence, a wrong seal (invalid)      | -
/// up      | its certificate ends (expired)                     | -
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
  /// Nothing is reached any more by the address that this node had: every link ends.
  void drop_all(const std::string& why, Now now, Effects& out);
  /// Everybody is dialled at once, whoever has the smaller id.
  void redial_all(Now now);
  /// This node is a member again: seeds, and peers without a link.
  void redial_unlinked(Now now);

  /// The link ends here. With `say_goodbye` the other side is told, if it can be.
  void drop(LinkId link, const std::string& why, bool say_goodbye, Now now, Effects& out);
  void on_ended(LinkId link, LinkEnd how, Now now, Effects& out);
  /// The frame that arrived on this link, or on a connection without one (0), cannot be decoded: the next of the link
  /// would be missing.
  void on_bad_frame(LinkId link, const Error& error, Now now, Effects& out);
  /// A connection that carries this link names another one: one connection is one link. It is over.
  void on_second_link(LinkId link, Now now, Effects& out);
  /// A seal of this link, or its absence, proves nothing: an alarm.
  void break_seal(LinkId link, const std::string& peer, SealFault fault, Now now, Effects& out);

  /// A seed's host name was found: what is dialled for this link is this, in numbers.
  void on_name_found(LinkId link, const std::string& address);
  /// It is not known, or not yet: the dial ends as one that failed. `why` is for people; empty: nothing to tell yet.
  void on_name_unknown(LinkId link, const std::string& why, Now now, Effects& out);

  /// A frame arrived on this link. False: it is out of sequence, and the link is over.
  bool receive(Link& link, const HeaderView& header, Now now, Effects& out);
  static void on_keep_alive(Link& link, const KeepAlive& body, Now now);

  /// The peer is at another address than was known: a dial to the old one ends.
  void set_address(Peer& peer, const std::string& address, Now now, Effects& out);
  void redial_later(Redial& redial, Now now, Duration at_least = {});
  /// It is soon dialled from here, or from there: the smaller id goes first.
  void redial_soon(Peer& peer, Now now);
  /// The services are told that the peer is gone.
  void expire(Peer& peer, const std::string& reason, Effects& out);

  /// With `may_dial` false nothing is dialled: this node is no member.
  void tick(bool may_dial, Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  struct Lapse {
    LinkId link;
    std::string_view code;
    std::string why;
  };
  void dial(Redial& redial, const std::string& address, BytesView key, Now now, Effects& out);
  void dial_peer(Peer& peer, bool may_dial, Now now, Effects& out);
  void dial_seed(Seed& seed, bool may_dial, Now now, Effects& out);
  void redial_failed(LinkId id, Now now);
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
