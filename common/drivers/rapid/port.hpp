// One connection to a RAPID server: a request waits for the previous one's answer; members' requests wait for a moment
// when the driver has none of its own.
#pragma once

#include <deque>

#include "common/drivers/driver.hpp"
#include "common/drivers/rapid/wire.hpp"

namespace trb::drivers {

/// What an answer is for.
enum class RapidPurpose : std::uint8_t { step, state, value, request, stop, release };

struct RapidAsk {
  RapidPurpose purpose{};
  int code = 0;
  std::string text;
  std::uint64_t about = 0;  ///< the requester's own mark
  MonotonicTime sent_at;
};

class RapidPort {
 public:
  explicit RapidPort(Channel channel) : channel_(channel) {}

  /// The driver's own. Never refused: it asks for values only if none of its own waits, and for one step at a time.
  void ask(RapidAsk ask, Now now, const DriverOut& out);
  /// A member's; send_request() sends it. The caller bounds their number.
  void request(RapidAsk ask) { requests_.push_back(std::move(ask)); }
  /// Sends the oldest request, if nothing is under way.
  void send_request(Now now, const DriverOut& out);
  /// Drops the request with that mark, unless it has been sent.
  void drop_request(std::uint64_t about);
  /// Sent at once, even before the previous answer.
  void urge(RapidAsk ask, Now now, const DriverOut& out);

  void add(BytesView bytes, Now now) { reader_.add(bytes, now.mono); }
  struct Answer {
    RapidAsk ask;
    RapidAnswer answer;
  };
  /// The next answer, if there is one; the driver's next is sent. Errors: malformed (not an answer, or to another code:
  /// the two sides are out of step), too_large.
  Result<std::optional<Answer>> next(Now now, const DriverOut& out);

  void clear();
  /// Nothing is under way.
  [[nodiscard]] bool free() const { return sent_.empty(); }
  /// Nothing of the driver's own waits or is under way.
  [[nodiscard]] bool idle() const;
  /// Something that was sent before the unanswered ask with that purpose and mark is itself unanswered.
  [[nodiscard]] bool has_before(RapidPurpose purpose, std::uint64_t about) const {
    return !sent_.empty() && !(sent_.front().purpose == purpose && sent_.front().about == about);
  }
  /// Since when the oldest request has been unanswered.
  [[nodiscard]] std::optional<MonotonicTime> unanswered_since() const;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return reader_.next_deadline(); }

 private:
  Channel channel_;
  RapidReader reader_;
  std::deque<RapidAsk> waiting_;   ///< the driver's own
  std::deque<RapidAsk> requests_;  ///< members'
  std::deque<RapidAsk> sent_;
};

}  // namespace trb::drivers
