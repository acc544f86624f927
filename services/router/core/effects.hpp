// What the router's core orders its shell to do. Values, so that tests and simulations can read them.
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "common/actor/log_line.hpp"
#include "common/base/time.hpp"
#include "proto/bodies/link.hpp"
#include "proto/message.hpp"

namespace trb::router {

using ConnectionId = std::uint32_t;  ///< a connection on the node's own bus, numbered by the shell from 1
using LinkId = std::uint64_t;

struct BusSend {
  ConnectionId to = 0;
  Message message;
};
/// The shell lets SealBook::send number it when it leaves.
struct LinkSend {
  LinkId link = 0;
  Message message;
  std::string peer{};  ///< whose message this node relays; empty: it is its own
};
struct Dial {
  LinkId link = 0;
  std::string address;  ///< of a seed it may be a host's name; then on_name_found() or on_name_unknown() follows
  Bytes server_key;
};
/// The other side's lossy lane: to be received beside this link and closed with it.
struct DialLane {
  LinkId link = 0;
  std::string address;
  Bytes server_key;
};
/// Dialled: the socket is closed. Accepted: the routing id is forgotten.
struct CloseLink {
  LinkId link = 0;
};
/// An accepted link: bind this link id to the inbox connection that sent the Hello.
struct AcceptLink {
  LinkId link = 0;
};
struct SendBeacon {
  Bytes plain;
};
/// The peers that were linked, for the next start: lines "ADDRESS KEY" (hexadecimal), the newest state, complete.
struct StorePeers {
  std::string text;
};
/// A Goodbye to a candidate that has no link yet: to the inbox connection whose message is being handled.
struct RefuseCandidate {
  LinkId link = 0;
  Message message;
  std::uint8_t version = kWireVersion;  ///< of the wire, in which the candidate reads it
};

/// What the authority has signed. It must be on disk before the next effects in the list are carried out. The list's
/// beacon key is used from then on, if this node has a box in it. TrustUpdates::on_stored follows this and the next
/// two.
struct StoreUpdate {
  TrustUpdate update;
  std::uint32_t beacon_number = 0;
  Bytes beacon_box;
  std::vector<Revocation> dropped{};  ///< by the list, too early: the next start must know them
};
/// This node's own renewed certificate: into keys/certificate.json.
struct StoreCertificate {
  SignedRecord record;
};
/// This start's boot number, which was not stored when it began.
struct StoreBoot {
  std::uint64_t boot = 0;
};
/// A lower bound of the time, for a start with a clock that is behind.
struct StoreUtc {
  UtcTime utc;
};

/// The unsealed frames of this link must be sealed before anything else leaves by it.
struct SealDue {
  LinkId link = 0;
};
/// A seal whose range fits: was it signed by `signer`? The answer goes to Forwarding::on_seal_checked.
struct CheckSeal {
  LinkId link = 0;
  std::uint64_t last = 0;    ///< sequence
  std::size_t messages = 0;  ///< that it seals
  SignedRecord record;
  std::shared_ptr<const Certificate> signer;
};
/// What was held of this link up to this sequence number is proven: deliver it.
struct DeliverHeld {
  LinkId link = 0;
  std::uint64_t last = 0;
};

/// The link ends: frames held for it are not delivered. With `may_send` it can still carry the Nacks; a seal and a
/// Goodbye follow.
struct ReturnHeld {
  LinkId link = 0;
  std::string peer;
  std::string why;
  bool may_send = false;
};

using Effect = std::variant<BusSend, LinkSend, Dial, CloseLink, AcceptLink, SendBeacon, StorePeers, RefuseCandidate,
                            Log, StoreUpdate, StoreCertificate, StoreBoot, StoreUtc, SealDue, CheckSeal, DeliverHeld,
                            DialLane, ReturnHeld>;

struct Effects {
  std::vector<Effect> list;
  std::vector<std::string> counts;
  void add(Effect effect);
  void log(LogLevel level, std::string event, std::string text);
  void count(std::string name);
};

/// A message wrapped for a relay, and the relay's link.
struct Relaying {
  LinkId link = 0;
  Message message;
};

/// Where a message goes. `relay`: wrapped by RelayRoutes::wrap. `lane`: only what may be lost.
struct Routing {
  enum class To : unsigned char { drop, service, peer, relay, every_peer, router, lane } to = To::drop;
  ConnectionId connection = 0;
  LinkId link = 0;
  Errc reason = Errc::ok;  ///< for drop
};

}  // namespace trb::router
