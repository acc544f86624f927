// The connection between this node and one peer by way of relays, end to end: is the peer there now, which messages
// arrived, which were lost? It trusts no relay.
#pragma once

#include <list>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "proto/bodies/link.hpp"
#include "services/router/core/effects.hpp"

namespace trb::router {

struct RelayTiming {
  Duration lease = std::chrono::seconds(10);
  Duration alive = std::chrono::milliseconds(2500);         ///< between messages while the other side is there
  Duration first = std::chrono::milliseconds(500);          ///< before the second one, without an answer; doubled
  Duration most = std::chrono::seconds(8);                  ///< the longest wait if the peer does not answer
  Duration acknowledge = std::chrono::milliseconds(100);    ///< messages that came are confirmed within this
  Duration confirmed_in = std::chrono::milliseconds(3000);  ///< an unconfirmed one may be lost: its sender is notified
};

/// A message that went by a relay and that the other router has not confirmed.
struct Unconfirmed {
  std::uint64_t count = 0;
  std::string relay;      ///< which carried it
  ConnectionId from = 0;  ///< of the own bus; 0: the router itself
  Message asked;          ///< its header; the data is left out
  MonotonicTime sent;
};

/// state   | event                                              | next
/// --------|----------------------------------------------------|--------------------------------------------------
/// unknown | a `relay_alive` with a nonce of ours of this lease | there: since that nonce was sent
/// unknown | any other one (late, replayed, from a lying relay) | unknown; its nonce is sent back
/// there   | one with our nonce, of the same boot               | there
/// there   | one with our nonce, of another boot                | there; it was restarted: counts begin anew
/// there   | one of another boot without our nonce (invalid)    | there; its nonce is sent back
/// there   | no nonce of ours came back for a lease (expired)   | unknown
/// any     | a count that was taken, or is 64 behind (repeated) | refused
/// any     | a message of a boot that is not proven (invalid)   | refused
/// Open: it is there, and has confirmed that it has proven this boot of ours. Messages go only then.
class RelayConnection {
 public:
  static constexpr std::size_t kMaxUnconfirmed = 256;
  static constexpr std::uint64_t kWindow = 64;  ///< counts that may overtake each other: a change of relays
  static constexpr std::size_t kAcknowledgeEach = 32;

  explicit RelayConnection(std::uint64_t own_boot = 0, RelayTiming timing = {})
      : timing_(timing), own_boot_(own_boot) {}

  // ---- out

  /// The number of the next frame.
  std::uint64_t next_count() { return ++sent_; }
  /// False: the limit of unconfirmed messages is reached; the frame must not go.
  [[nodiscard]] bool has_room() const { return unconfirmed_.size() < kMaxUnconfirmed; }
  void remember(Unconfirmed question) { unconfirmed_.push_back(std::move(question)); }
  /// nullptr: it is not waited for.
  [[nodiscard]] const Unconfirmed* find(std::uint64_t count) const;
  /// It did not leave, or a relay reports that it could not pass it on. Nothing if it is not waited for.
  std::optional<Unconfirmed> withdraw(std::uint64_t count);

  // ---- `relay_alive` of both ends

  /// Sends a `relay_alive` at once, or at `at`: a relay claims to reach the peer.
  void begin(MonotonicTime at);
  /// Stops sending: there is a link, or no relay.
  void rest() { next_alive_.reset(); }
  /// The next `relay_alive`; `own` has the fields that do not belong to the connection.
  RelayAlive make_alive(RelayAlive own, std::uint64_t nonce, MonotonicTime now);
  struct Received {
    bool fresh = false;             ///< it repeats a nonce of ours: it was sent just now
    bool new_boot = false;          ///< of another boot than the proven one, or the first
    std::vector<Unconfirmed> lost;  ///< did not arrive, though later ones did
  };
  /// A `relay_alive` of the other side, with its boot and count.
  Received on_alive(const RelayAlive& alive, std::uint64_t boot, std::uint64_t count, MonotonicTime now);

  // ---- in

  /// Takes a message if it is new. `answer`: its sender waits for a confirmation.
  bool take(std::uint64_t boot, std::uint64_t count, bool answer, MonotonicTime now);

  [[nodiscard]] bool proven() const { return since_.has_value(); }
  [[nodiscard]] bool open() const { return since_.has_value() && knows_us_; }
  /// When the peer was last known to be there.
  [[nodiscard]] MonotonicTime last_sign() const { return last_sign_; }
  [[nodiscard]] std::uint64_t boot() const { return boot_; }

  // ---- time

  [[nodiscard]] bool alive_due(MonotonicTime now) const { return next_alive_ && now >= *next_alive_; }
  /// Two messages went unanswered: try another relay.
  [[nodiscard]] bool is_unanswered() const { return unanswered_ >= 2; }
  /// Those that were not confirmed in time.
  std::vector<Unconfirmed> overdue(MonotonicTime now);
  /// All that is unconfirmed, at the end of the connection.
  std::vector<Unconfirmed> take_all();
  /// True once, when the last sign of life is a lease ago.
  bool lapse(MonotonicTime now);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  struct Nonce {
    std::uint64_t value = 0;
    MonotonicTime sent;
  };
  void send_by(MonotonicTime at);
  std::vector<Unconfirmed> restart(std::uint64_t boot, std::uint64_t count);
  void settle(const RelayAlive& alive, std::vector<Unconfirmed>& lost);

  RelayTiming timing_;
  std::uint64_t sent_ = 0;
  std::vector<Nonce> nonces_;  ///< the last eight
  std::uint64_t own_boot_ = 0;
  bool knows_us_ = false;         ///< the other side has proven this boot of ours
  std::uint64_t echo_ = 0;        ///< the other side's newest nonce, of the proven boot
  std::uint64_t echo_other_ = 0;  ///< and of another boot
  std::uint64_t boot_ = 0;        ///< proven
  std::uint64_t highest_ = 0;     ///< highest count taken
  std::uint64_t mask_ = 0;        ///< bit i: highest_ - i was taken
  std::size_t untold_ = 0;        ///< taken, and not yet confirmed to the sender
  std::uint32_t unanswered_ = 0;  ///< messages sent since a nonce came back
  std::optional<MonotonicTime> since_;
  MonotonicTime last_sign_{};  ///< stays when `since_` is over
  std::optional<MonotonicTime> next_alive_;
  MonotonicTime last_alive_{};
  Duration wait_{};
  std::list<Unconfirmed> unconfirmed_;
};

}  // namespace trb::router
