// Messages for this router itself: from a link, from a connection that has none yet, from a relay.
#pragma once

#include "services/router/core/answers.hpp"
#include "services/router/core/handshake.hpp"
#include "services/router/core/invitations.hpp"
#include "services/router/core/known_addresses.hpp"
#include "services/router/core/lane_table.hpp"
#include "services/router/core/reachable_peers.hpp"
#include "services/router/core/routing.hpp"
#include "services/router/core/tell_again.hpp"

namespace trb::router {

/// The objects that get the messages of a link.
struct LinkParts {
  const LocalNode& node;
  PeerTable& table;
  TrustStore& trust;
  Admission& admission;
  OwnMessages& messages;
  LocalBus& bus;
  SealBook& seals;
  Links& links;
  LinkErrors& errors;
  LocalProfile& profile;
  LaneTable& lanes;
  KnownAddresses& known;
  Handshake& handshake;
  TrustUpdates& updates;
  RelayRoutes& relays;
  ReachablePeers& reachable;
  TellAgain& tell_again;
  Answers& answers;
  Invitations& invitations;
  MessageRouting& routing;
};

/// first message        | of                        | what follows
/// ---------------------|---------------------------|---------------------------------------------------------------
/// Hello                | any connection            | Handshake
/// JoinCall             | an invited key            | Invitations: the answer is its last word
/// another (invalid)    | a stranger                | refused: its first message must be Hello
/// another              | a member, link just closed | dropped.closed_link
/// TrustUpdate          | a link that is dialled    | its list and this node's certificate: both may be missed here
/// TrustUpdate again    | a link that is dialled    | the link is dropped: nothing else bounds the checks
/// Goodbye              | a link that is dialled    | refused by the other side; dialled again
class LinkInbox {
 public:
  explicit LinkInbox(const LinkParts& parts) : at_(parts) {}

  /// A message for the router itself, or the first one (Hello). `key`: of the connection; empty: proven to be the
  /// link's.
  void on_message(LinkId link, BytesView key, const Message& message, std::uint64_t sequence, Now now, Effects& out);
  /// Most of what a link brings for its router: seals and keep-alives that can be read, of a link that is up. False:
  /// it is something else, or cannot be decoded.
  bool on_usual(Link& link, const HeaderView& header, Now now, Effects& out);
  /// A connection has named a link that is another connection's: counted and logged.
  static void refuse_theft(Effects& out);
  /// The Hello that waited for one more message is accepted.
  void carry(Link& link, const Hello& hello, Now now, Effects& out);

 private:
  void on_early_message(LinkId link, BytesView key, const Message& message, Now now, Effects& out);
  void on_join_call(LinkId link, BytesView key, const Message& message, Now now, Effects& out);
  void on_dialled_message(Link& link, const Message& message, Now now, Effects& out);
  void on_peer_message(Link& link, const Message& message, Now now, Effects& out);
  void on_body(Link& link, const Message& message, const Body& body, Now now, Effects& out);
  void on_seal(const Link& link, Seal seal, Now now, Effects& out);
  void on_goodbye(const Link& link, const Goodbye& goodbye, Now now, Effects& out);
  void on_request(const Link& link, const Message& message, Now now, Effects& out);
  Result<Body> answer_to(Peer& peer, const Message& message, Now now, Effects& out);
  void on_profile(Peer& peer, BytesView data, Now now, Effects& out);
  void on_relayed(const Link& link, const Message& message, const Relayed& body, Now now, Effects& out);
  void deliver_relayed(Peer& source, BytesView frame, Now now, Effects& out);
  void answer_relayed(Peer& peer, const Message& request, Now now, Effects& out);
  void answer(const Link& link, const Message& request, const Body& body, Effects& out);
  void deny(const Link& link, const Message& message, const Error& error, Effects& out);
  void on_carried(const Carried& carried, Now now, Effects& out);

  LinkParts at_;
};

}  // namespace trb::router
