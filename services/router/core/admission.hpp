// Which keys may connect to the inbox: members always; strangers a few at a time, for a short time.
#pragma once

#include <map>
#include <set>

#include "services/router/core/trust_store.hpp"

namespace trb::router {

/// key       | event                                     | next
/// ----------|-------------------------------------------|-------------------------------------------------------
/// unknown   | connects, there is room for a candidate   | candidate for 2 s; reconnecting gives no more time
/// unknown   | connects, there is no room                | unknown, refused
/// candidate | its Hello is accepted                     | member
/// candidate | its Hello is refused, or another message  | denied for 10 s
/// candidate | 2 s (expired)                             | denied for 10 s
/// member    | connects                                  | member, admitted
/// member    | sends Hello too often                     | noisy: out for 10 s
/// member    | parts of a message without end (Links)    | out for 10 s
/// any       | an invitation names it                    | invited: admitted until that is over
/// any       | is revoked                                | refused while it is on the list
class Admission {
 public:
  Admission(const LocalNode& node, PeerTable& table, TrustStore& trust) : node_(node), table_(table), trust_(trust) {}

  /// ZAP's question: may this key connect?
  bool admit(BytesView key, Now now, Effects& out);
  /// Was this key refused a moment ago?
  [[nodiscard]] bool is_denied(BytesView key, MonotonicTime now) const;
  /// The key is no longer a candidate.
  void settle(BytesView key);
  void deny(BytesView key, MonotonicTime now);
  /// The key that a code gives may connect: no crowd of strangers keeps it out.
  void invite(BytesView key);
  void withdraw(BytesView key);
  /// Keeps a member's key out for a while.
  void silence(BytesView key, MonotonicTime now);

  void tick(Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  using Keys = std::map<Bytes, MonotonicTime, std::less<>>;
  bool admit_stranger(BytesView key, MonotonicTime now, Effects& out);

  const LocalNode& node_;
  PeerTable& table_;
  TrustStore& trust_;
  Keys candidates_;  ///< until when a Hello must have come
  Keys denied_;      ///< until when it stays out
  Keys noisy_;       ///< members', until when they stay out
  std::set<Bytes, std::less<>> invited_;
};

}  // namespace trb::router
