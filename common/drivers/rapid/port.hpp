// One connection to a RAPID server: a request waits for the previous one's answer.
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
  static constexpr std::size_t kMost = 128;

  explicit RapidPort(Channel channel) : channel_(channel) {}

  /// False: the queue is full.
  bool ask(RapidAsk ask, Now now, const DriverOut& out);
  /// Sent at once, even before the previous answer.
  void urge(RapidAsk ask, Now now, const DriverOut& out);
  void drop_waiting(RapidPurpose purpose);

  void add(BytesView bytes, Now now) { reader_.add(bytes, now.mono); }
  struct Answer {
    RapidAsk ask;
    RapidAnswer answer;
  };
  /// The next answer, if there is one; the next request is sent. Errors: malformed (not an answer, or to another code:
  /// the two sides are out of step), too_large.
  Result<std::optional<Answer>> next(Now now, const DriverOut& out);

  void clear();
  [[nodiscard]] bool idle() const { return sent_.empty() && waiting_.empty(); }
  /// Since when the oldest request has been unanswered.
  [[nodiscard]] std::optional<MonotonicTime> unanswered_since() const;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return reader_.next_deadline(); }

 private:
  Channel channel_;
  RapidReader reader_;
  std::deque<RapidAsk> waiting_;
  std::deque<RapidAsk> sent_;
};

}  // namespace trb::drivers
