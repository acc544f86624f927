// The connection between this node and one peer by way of relays, end to end: is the peer there now, what has come,
// what was lost? A relay is believed in nothing of it.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "proto/bodies/link.hpp"
#include "services/router/core/effects.hpp"

namespace trb::router {

struct RelayTiming {
  Duration lease = std::chrono::seconds(10);
  Duration alive = std::chrono::milliseconds(2500);         ///< between words while the other side is there
  Duration first = std::chrono::milliseconds(500);          ///< before the second word to who has not answered; doubled
  Duration most = std::chrono::seconds(8);                  ///< between words to who does not answer
  Duration acknowledge = std::chrono::milliseconds(100);    ///< what came is confirmed within this
  Duration confirmed_in = std::chrono::milliseconds(3000);  ///< what is not by then may be lost: its sender is told
};

/// A question that went by a relay and that the other router has not confirmed.
struct Unconfirmed {
  std::uint64_t count = 0;
  std::string relay;      ///< by whom it went
  ConnectionId from = 0;  ///< of the own bus; 0: the router itself
  Message asked;          ///< its header; the data is left out
  MonotonicTime sent;
};

/// state   | event                                              | next
/// --------|----------------------------------------------------|--------------------------------------------------
/// unknown | a word that repeats a nonce of the last lease      | there: since that nonce was sent
/// unknown | any other word (late, replayed, of a lying relay)  | unknown; its nonce is repeated to it
/// there   | a word that repeats one, of the same boot          | there
/// there   | a word that repeats one, of another boot           | there; it was restarted: counts begin anew
/// there   | a word of another boot that repeats none (invalid) | there; its nonce is repeated to it
/// there   | no nonce repeated for a lease (expired)            | unknown
/// any     | a count that was taken, or is 64 behind (repeated) | refused
/// any     | a message of another boot than the proven (invalid)| refused
/// Open: it is there, and has said that it has proven this boot of ours. Only then messages go.
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
  /// False: as many as may be are unconfirmed already; the frame must not go.
  [[nodiscard]] bool has_room() const { return unconfirmed_.size() < kMaxUnconfirmed; }
  void remember(Unconfirmed question) { unconfirmed_.push_back(std::move(question)); }
  /// It did not leave, or a relay says that it could not pass it on. Nothing if it is not waited for.
  std::optional<Unconfirmed> withdraw(std::uint64_t count);

  // ---- the words of both ends

  /// Say something at once, or at `at`: a relay claims to reach it.
  void begin(MonotonicTime at);
  /// Nothing is said any more: there is a link, or no relay.
  void rest() { next_word_.reset(); }
  /// The next word; `own` has the fields that are not the connection's.
  RelayAlive make_word(RelayAlive own, std::uint64_t nonce, MonotonicTime now);
  struct Heard {
    bool fresh = false;             ///< it repeats a nonce of ours: what it says is said now
    bool new_boot = false;          ///< of another boot than the proven one, or the first
    std::vector<Unconfirmed> lost;  ///< did not come, though later ones did
  };
  /// What the other side says, of this boot and count of its.
  Heard hear(const RelayAlive& word, std::uint64_t boot, std::uint64_t count, MonotonicTime now);

  // ---- in

  /// Is this one new? Then it is taken. `answer`: who sent it waits to hear whether it came.
  bool take(std::uint64_t boot, std::uint64_t count, bool answer, MonotonicTime now);

  [[nodiscard]] bool proven() const { return since_.has_value(); }
  [[nodiscard]] bool open() const { return since_.has_value() && knows_us_; }
  /// The last moment at which it is known to have been there.
  [[nodiscard]] MonotonicTime last_sign() const { return since_.value_or(MonotonicTime{}); }
  [[nodiscard]] std::uint64_t boot() const { return boot_; }

  // ---- time

  [[nodiscard]] bool word_due(MonotonicTime now) const { return next_word_ && now >= *next_word_; }
  /// Nobody has repeated what was said twice: try another relay.
  [[nodiscard]] bool unheard() const { return unanswered_ >= 2; }
  /// Those that nobody has confirmed in time.
  std::vector<Unconfirmed> overdue(MonotonicTime now);
  /// All that is unconfirmed, at the end of the connection.
  std::vector<Unconfirmed> take_all();
  /// True once: the last sign of life is a lease ago.
  bool lapse(MonotonicTime now);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  struct Nonce {
    std::uint64_t value = 0;
    MonotonicTime sent;
  };
  void say_by(MonotonicTime at);
  std::vector<Unconfirmed> restart(std::uint64_t boot, std::uint64_t count);
  void settle(const RelayAlive& word, std::vector<Unconfirmed>& lost);

  RelayTiming timing_;
  std::uint64_t sent_ = 0;
  std::deque<Nonce> nonces_;  ///< the last eight
  std::uint64_t own_boot_ = 0;
  bool knows_us_ = false;         ///< the other side has proven this boot of ours
  std::uint64_t echo_ = 0;        ///< the other side's newest, of the proven boot
  std::uint64_t echo_other_ = 0;  ///< and of another
  std::uint64_t boot_ = 0;        ///< proven
  std::uint64_t highest_ = 0;     ///< count taken
  std::uint64_t mask_ = 0;        ///< bit i: highest_ - i was taken
  std::size_t untold_ = 0;        ///< taken, and not yet confirmed to who sent it
  std::uint32_t unanswered_ = 0;  ///< words since one was repeated
  std::optional<MonotonicTime> since_;
  std::optional<MonotonicTime> next_word_;
  MonotonicTime last_word_{};
  Duration wait_{};
  std::deque<Unconfirmed> unconfirmed_;
};

}  // namespace trb::router
