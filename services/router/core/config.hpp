// What a router gets at its start.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "common/security/keys.hpp"
#include "proto/bodies/link.hpp"

namespace trb::router {

struct SeedAddress {
  std::string address;  ///< HOST:PORT
  Bytes key;            ///< CURVE public key, 32 bytes
};

struct Timing {
  Duration lease = std::chrono::seconds(10);
  Duration keep_alive = std::chrono::milliseconds(2500);  ///< four in a lease
  Duration handshake = std::chrono::seconds(2);           ///< from dial or candidate to Hello
  Duration redial_first = std::chrono::milliseconds(200);
  Duration redial_most = std::chrono::seconds(2);
  Duration yield = std::chrono::milliseconds(1000);  ///< the greater id lets the smaller one dial first
  Duration beacon = std::chrono::seconds(5);
  Duration denied = std::chrono::seconds(10);  ///< how long a refused key stays out
  Duration service_silent = std::chrono::seconds(3);
};

struct RouterConfig {
  std::string id;
  Role role{};
  FleetAuthority authority;
  SignedRecord certificate;
  Certificate own;
  SigningKey identity;
  LinkKey link_key;
  std::string address;  ///< HOST:PORT of the inbox
  std::string lane;     ///< HOST:PORT of the lossy lane; empty: none
  std::uint64_t boot = 1;
  Status boot_stored = Done{};  ///< why it is not on disk
  std::uint64_t instance = 1;
  std::uint32_t pid = 0;
  std::uint16_t first_slot = 1;
  std::string version;
  std::vector<SeedAddress> seeds;
  std::vector<SeedAddress> known;     ///< peers that were linked before the last end: hints where to dial
  std::vector<std::string> services;  ///< that may claim subtypes
  bool beacon = true;
  bool relay = false;                   ///< relays, if its certificate has the right
  std::vector<Revocation> dropped;      ///< StoreUpdate's, of the start before
  TrustUpdate updates;                  ///< what the authority has signed before this start, the list first of all
  std::optional<Error> updates_lost{};  ///< why what it has signed is not known: then nobody can be judged
  UtcTime utc_bound;                    ///< a time that has certainly passed; of an earlier start
  bool seal_before_delivery = false;    ///< deliver what comes by a link only once its seal was checked
  Timing timing;
  /// Unpredictable numbers: ids of links, nonces. The shell provides libsodium's.
  std::function<std::uint64_t()> random;
  /// Has this link room for a frame of this size? Asked before a megabyte is hashed for nothing; empty: always.
  std::function<bool(std::uint64_t link, std::size_t bytes)> has_room;
  /// For people: what is wrong with the node's computer, as a disk with little room; empty: nothing.
  std::function<std::string()> machine_note{};
};

/// From when on people are warned that a certificate ends.
constexpr Duration kWarnBefore = std::chrono::hours(24 * 30);
constexpr Duration kWarnEvery = std::chrono::hours(24);
constexpr std::size_t kMaxUpdate = 516U * 1024U;  ///< of a TrustUpdate: the largest signed list, and what is around it
constexpr std::size_t kMaxCandidates = 32;
constexpr std::size_t kMaxHelloSize = 4096;
constexpr std::size_t kMaxPeers = 1024;
constexpr std::string_view kFullCure =
    "1024 nodes are the most: revoke those that are gone for good, and start this one again";
constexpr std::uint32_t kBeaconsChecked = 512;   ///< signatures of beacons, in a second: a thousand nodes send 200
constexpr std::uint32_t kHellosOfOne = 8;        ///< of one member, in a second
constexpr std::size_t kSpareLinks = 2;           ///< accepted of one member, beside the one that carries
constexpr std::uint32_t kUpdatesOfOne = 16;      ///< fleet_news of one member, in a second
constexpr std::uint32_t kInvitationsOfOne = 16;  ///< signatures of invitations that one member brings, in a second
constexpr std::uint32_t kUpdatesChecked = 300;   ///< signatures in them, in a second: a message brings 257 at most
constexpr std::uint32_t kReachChecked = kMaxPeers + 64;  ///< signatures of whom one relay reaches, in a second
constexpr std::uint32_t kRelayedChecked = 1000;  ///< signatures of what one relay brings of one source, in a second
constexpr std::uint32_t kCarriedOfOne = 2 * kRelayedChecked;  ///< what a relay passes on of one source, in a second
constexpr std::uint32_t kRelayedForged = 100;        ///< forged ones of one relay, whomever they name, in a second
constexpr std::uint64_t kAnsweredOfOne = 4U << 20U;  ///< bytes of tables for one member, in a second
constexpr Duration kStorePause = std::chrono::seconds(5);  ///< changes of where peers are, gathered for one write
constexpr Duration kViaPause = std::chrono::seconds(4);    ///< between dials to who is reached by a relay
constexpr Duration kHintPause = std::chrono::seconds(30);  ///< between dials to where a peer once was
constexpr std::size_t kMaxWaiting = 16;      ///< who brought trust updates and wait until these are on disk
constexpr std::size_t kMaxConnections = 64;  ///< on the node's own bus

}  // namespace trb::router
