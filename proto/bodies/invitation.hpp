// How a new node gets its certificate through a cloud node: the authority's invitation, and the mailbox that the cloud
// node keeps for it. Inviter and new node exchange boxes that only the code opens (common/security/invitation.hpp).
#pragma once

#include "proto/bodies/signed.hpp"
#include "proto/field.hpp"
#include "proto/travel.hpp"

namespace trb {

constexpr std::uint32_t kMaxJoinBox = 2048;  ///< of a new node: a request and its envelope take 400 bytes
constexpr std::uint32_t kMaxJoinOffer =
    32U * 1024;                             ///< of the inviter: goes through a slow VPN before its connection is cut
constexpr std::uint32_t kMaxJoinBoxes = 4;  ///< for one invitation: words of the node, and of who else has it
constexpr std::uint32_t kMaxFleetSeeds = 16;

/// What the authority allows: whoever proves this key until then may leave a word for the inviter. Signed with purpose
/// "invitation".
struct Invitation {
  static constexpr std::string_view kSubtype = "invitation";
  static constexpr Travel kTravel = in_record();
  Blob fleet;  ///< 16 bytes
  std::string name;
  Role role{};
  Blob caller;               ///< CURVE public key, 32 bytes, made from the code
  std::int64_t expires = 0;  ///< UTC ns
  template <class T = Invitation>
  static FieldTable fields() {
    return FieldTable{field("fleet", &T::fleet, 16), field("name", &T::name, 64), field("role", &T::role),
                      field("caller", &T::caller, 32), field("expires", &T::expires)};
  }
};

/// A node with a code to a cloud node: the first and only message of its connection.
struct JoinCall {
  static constexpr std::string_view kSubtype = "join_call";
  static constexpr Travel kTravel = between_routers(CostPhase::identification);
  Blob word;  ///< a JoinWord, locked; empty: it only asks for the offer
  bool operator==(const JoinCall&) const = default;
  template <class T = JoinCall>
  static FieldTable fields() {
    return FieldTable{field("word", &T::word, kMaxJoinBox)};
  }
};

/// The inviter to a cloud node, again and again: keep this invitation and its offer. Answered with InvitationState.
struct HoldInvitation {
  static constexpr std::string_view kSubtype = "hold_invitation";
  static constexpr Travel kTravel = between_nodes(CostPhase::identification, {kProbe});
  SignedRecord invitation;
  std::uint64_t number = 0;  ///< of the offer; it rises with each new one
  Blob offer;                ///< a JoinOffer, locked; empty: the one of that number is there already
  bool over = false;         ///< nobody waits for words any more
  template <class T = HoldInvitation>
  static FieldTable fields() {
    return FieldTable{field("invitation", &T::invitation), field("number", &T::number),
                      field("offer", &T::offer, kMaxJoinOffer), field("over", &T::over)};
  }
};

struct InvitationState {
  static constexpr std::string_view kSubtype = "invitation_state";
  static constexpr Travel kTravel = between_nodes(CostPhase::identification);
  std::uint64_t number = 0;     ///< of the offer that is kept; 0: none
  std::vector<JoinCall> words;  ///< of the last calls, the oldest first
  template <class T = InvitationState>
  static FieldTable fields() {
    return FieldTable{field("number", &T::number), field("words", &T::words, kMaxJoinBoxes)};
  }
};

/// The answer to a JoinCall; the connection ends with it.
struct JoinAnswer {
  static constexpr std::string_view kSubtype = "join_answer";
  static constexpr Travel kTravel = between_routers(CostPhase::identification);
  Blob offer;  ///< a JoinOffer, locked; empty: there is none yet
  template <class T = JoinAnswer>
  static FieldTable fields() {
    return FieldTable{field("offer", &T::offer, kMaxJoinOffer)};
  }
};

/// A cloud node that a new node can dial.
struct FleetSeed {
  std::string address;  ///< HOST:PORT
  Blob key;             ///< CURVE public key, 32 bytes
  bool operator==(const FleetSeed&) const = default;
  template <class T = FleetSeed>
  static FieldTable fields() {
    return FieldTable{field("address", &T::address, 80), field("key", &T::key, 32)};
  }
};

/// The inviter to the new node: who is invited, and once a request was signed, the certificate.
struct JoinOffer {
  static constexpr std::string_view kSubtype = "join_offer";
  static constexpr Travel kTravel = in_record();
  std::string name;
  Role role{};
  std::string fleet;         ///< its name, for people
  Blob authority_key;        ///< Ed25519, 32 bytes
  Blob request;              ///< the digest of the request that was answered; empty: none yet
  std::string refused;       ///< why that request was refused; empty: it was signed
  SignedRecord certificate;  ///< an empty kind for none
  std::uint32_t beacon_number = 0;
  Blob sealed_beacon;        ///< for the new node's link key
  SignedRecord revocations;  ///< an empty kind for none
  std::vector<FleetSeed> seeds;
  template <class T = JoinOffer>
  static FieldTable fields() {
    return FieldTable{field("name", &T::name, 64),
                      field("role", &T::role),
                      field("fleet", &T::fleet, 64),
                      field("authority_key", &T::authority_key, 32),
                      field("request", &T::request, 32),
                      field("refused", &T::refused),
                      field("certificate", &T::certificate),
                      field("beacon_number", &T::beacon_number),
                      field("sealed_beacon", &T::sealed_beacon, 80),
                      field("revocations", &T::revocations),
                      field("seeds", &T::seeds, kMaxFleetSeeds)};
  }
};

/// The new node to the inviter.
struct JoinWord {
  static constexpr std::string_view kSubtype = "join_word";
  static constexpr Travel kTravel = in_record();
  SignedRecord request;  ///< a CertificateRequest
  bool done = false;     ///< it has the certificate on its disk
  template <class T = JoinWord>
  static FieldTable fields() {
    return FieldTable{field("request", &T::request), field("done", &T::done)};
  }
};

}  // namespace trb
