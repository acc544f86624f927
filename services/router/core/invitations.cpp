#include "services/router/core/invitations.hpp"

#include <algorithm>

namespace trb::router {

MonotonicTime Invitations::end_of(const Held& held) {
  return held.over ? held.until : std::min(held.until, held.silent);
}

Result<InvitationState> Invitations::hold(const HoldInvitation& order, Budget& checks, Now now, Effects& out) {
  if (node_.config().role != Role::cloud) {
    return fail(Errc::not_permitted, "'" + node_.id() + "' is a robot's node: it keeps no invitations",
                "invite through a cloud node: --through NAME");
  }
  auto found = find(order, checks, now, out);
  if (!found) return found.error();
  Held& held = **found;
  held.silent = now.mono + kInviterSilent;
  if (!order.offer.bytes.empty() && order.number > held.number) {
    held.number = order.number;
    held.offer = order.offer.bytes;
  }
  const InvitationState state{held.number, held.words};
  if (order.over && order.number == 0) {
    forget(held_.find(held.invitation.caller.bytes), "withdrawn", out);
  } else if (order.over) {
    held.over = true;
    held.words.clear();
  }
  return state;
}

/// Whose inviter waits no more only answers: it makes room for one that is open.
bool Invitations::make_room(Effects& out) {
  if (held_.size() < kMaxInvitations) return true;
  auto oldest = held_.end();
  for (auto at = held_.begin(); at != held_.end(); ++at) {
    if (at->second.over && (oldest == held_.end() || at->second.until < oldest->second.until)) oldest = at;
  }
  if (oldest == held_.end()) return false;
  forget(oldest, "its place is needed", out);
  return true;
}

/// The one that is held, or a new one. A signature is checked only of a new one.
Result<Invitations::Held*> Invitations::find(const HoldInvitation& order, Budget& checks, Now now, Effects& out) {
  for (auto& [key, held] : held_) {
    if (held.record == order.invitation) return &held;
  }
  if (!checks.take(now.mono)) return fail(Errc::queue_full, "too many invitations in a second", "invite one by one");
  const UtcTime utc = node_.checked_utc(now.utc);
  auto invitation = open_invitation(order.invitation, node_.config().authority, utc);
  if (!invitation) return invitation.error();
  if (!make_room(out)) {
    return fail(Errc::queue_full, std::to_string(kMaxInvitations) + " invitations are open here, which are the most",
                "wait until one has been used or has ended");
  }
  const Bytes key = invitation->caller.bytes;
  const Duration left = std::min<Duration>(kInvitationTime, Duration{invitation->expires - utc.ns});
  Held held;
  held.record = order.invitation;
  held.invitation = std::move(*invitation);
  held.until = now.mono + left;
  admission_.invite(key);
  out.count("invitations.held");
  out.log(LogLevel::info, "invited", "'" + held.invitation.name + "', until " + to_iso8601({held.invitation.expires}));
  return &held_.insert_or_assign(key, std::move(held)).first->second;
}

Result<JoinAnswer> Invitations::call(BytesView key, const JoinCall& call, Now now, Effects& out) {
  Held& held = held_.find(key)->second;
  if (!held.calls.take(now.mono))
    return fail(Errc::queue_full, "the code of '" + held.invitation.name + "' calls too often");
  out.count("invitations.calls");
  const bool known = std::ranges::find(held.words, call) != held.words.end();
  if (!held.over && !known && !call.word.bytes.empty()) {
    // The inviter has read the oldest by now: it comes twice in a second.
    if (held.words.size() >= kMaxJoinBoxes) held.words.erase(held.words.begin());
    held.words.push_back(call);
  }
  return JoinAnswer{{held.offer}};
}

void Invitations::forget(HeldByKey::iterator at, const char* why, Effects& out) {
  out.log(LogLevel::info, "invitation_over", "'" + at->second.invitation.name + "': " + why);
  admission_.withdraw(at->first);
  held_.erase(at);
}

void Invitations::tick(Now now, Effects& out) {
  for (auto at = held_.begin(); at != held_.end();) {
    const auto next = std::next(at);
    if (now.mono >= end_of(at->second))
      forget(at, now.mono >= at->second.until ? "its time is over" : "its inviter has gone", out);
    at = next;
  }
}

std::optional<MonotonicTime> Invitations::next_deadline() const {
  std::optional<MonotonicTime> next;
  for (const auto& [key, held] : held_) next = earlier(next, end_of(held));
  return next;
}

}  // namespace trb::router
