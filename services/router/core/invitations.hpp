// The mailbox of a cloud node for invitations: it carries locked words between an inviter and the node that has the
// code.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "common/security/invitation.hpp"
#include "services/router/core/admission.hpp"
#include "services/router/core/budget.hpp"

namespace trb::router {

constexpr std::size_t kMaxInvitations = 16;  ///< open ones; beside them those that are over, while there is room
constexpr std::uint32_t kJoinCalls = 8;      ///< of one code, in a second: a node calls three times
constexpr Duration kInviterSilent = std::chrono::seconds(15);

/// invitation | event                                       | next
/// -----------|---------------------------------------------|------------------------------------------------------
/// -          | the authority's, from any member            | held: its key may call
/// -          | forged, of another fleet, ended (invalid)   | -, the error by name
/// held       | the same again                              | held 15 s more, its offer replaced by a newer one
/// held       | a call with its key                         | the call's word is kept, the newest offer answered
/// held       | the inviter is silent for 15 s (expired)    | -
/// held       | `over`, before any word was answered        | -
/// held       | `over`                                      | over: it answers the last offer, and keeps no word
/// over       | its place is needed (the oldest goes first) | -
/// any        | ten minutes, or its end by the clock        | -
/// -          | a call with its key                         | as any stranger's: refused
class Invitations {
 public:
  Invitations(const LocalNode& node, Admission& admission) : node_(node), admission_(admission) {}

  /// From an inviter. `checks`: the signatures that its node may have checked: no member uses up another's. Errors:
  /// not_permitted (not a cloud node), those of open_invitation, queue_full.
  Result<InvitationState> hold(const HoldInvitation& order, Budget& checks, Now now, Effects& out);
  /// From an inviter on this node's own bus.
  Result<InvitationState> hold_own(const HoldInvitation& order, Now now, Effects& out) {
    return hold(order, own_checks_, now, out);
  }

  /// May this key call?
  [[nodiscard]] bool is_invited(BytesView key) const { return held_.contains(key); }
  /// A call of an invited key. Errors: queue_full: it calls too often.
  Result<JoinAnswer> call(BytesView key, const JoinCall& call, Now now, Effects& out);

  void tick(Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  struct Held {
    SignedRecord record;
    Invitation invitation;
    std::uint64_t number = 0;
    Bytes offer;
    std::vector<JoinCall> words;
    MonotonicTime until;   ///< its end
    MonotonicTime silent;  ///< the inviter must have come again by then
    bool over = false;
    Budget calls{kJoinCalls};
  };
  using HeldByKey = std::map<Bytes, Held, std::less<>>;

  Result<Held*> find(const HoldInvitation& order, Budget& checks, Now now, Effects& out);
  bool make_room(Effects& out);
  void forget(HeldByKey::iterator at, const char* why, Effects& out);
  [[nodiscard]] static MonotonicTime end_of(const Held& held);

  const LocalNode& node_;
  Admission& admission_;
  HeldByKey held_;  ///< by the key of the caller
  Budget own_checks_{kInvitationsOfOne};
};

}  // namespace trb::router
