// The exchange with a C3 server: one request at a time, answers matched by their tags.
#pragma once

#include <deque>
#include <map>
#include <optional>

#include "common/drivers/c3/wire.hpp"
#include "common/drivers/driver.hpp"

namespace trb::drivers {

/// What an answer is for.
enum class C3Purpose : std::uint8_t { step, probe, part, clear, value, request, stop, release, note };

struct C3Ask {
  C3Purpose purpose{};
  std::string variable;
  std::optional<std::string> value;  ///< written; none: read
  std::uint64_t about = 0;           ///< the requester's own mark
};

/// event          | what follows
/// ---------------|----------------------------------------------------------------
/// ask            | the driver's own: waits for the answers of all before it, then is sent
/// request        | a member's: waits until nothing of the driver's own waits
/// urge           | sent at once, whatever waits or is under way
/// an answer      | its ask, and the next one is sent; of an unknown tag: counted, ignored
/// 2 s, no answer | hung(): the connection is of no use any more
///
/// So members delay each of the driver's own by one answer at most.
class C3Link {
 public:
  static constexpr Duration kAnswerTime = std::chrono::seconds(2);

  /// Never refused: the driver asks for its values only if idle(), and has one step and one withdrawal at a time.
  void ask(C3Ask ask, Now now, const DriverOut& out);
  /// The caller bounds their number.
  void request(C3Ask ask, Now now, const DriverOut& out);
  void urge(C3Ask ask, Now now, const DriverOut& out);
  /// Drops what the driver asks for that purpose and has not been sent.
  void drop_waiting(C3Purpose purpose);
  /// Drops the request with that mark, unless it has been sent.
  void drop_request(std::uint64_t about);

  struct Answer {
    C3Ask ask;
    C3Reply reply;
  };
  /// The request that the reply answers; the next request is sent.
  std::optional<Answer> take(C3Reply reply, Now now, const DriverOut& out);

  void clear();
  /// Nothing of the driver's own waits or is under way.
  [[nodiscard]] bool idle() const;
  /// Something else than the asks with that purpose and mark is unanswered. Only urge() sends behind another: so it was
  /// sent before them.
  [[nodiscard]] bool has_before(C3Purpose purpose, std::uint64_t about) const;
  [[nodiscard]] bool hung(Now now) const;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  struct Sent {
    C3Ask ask;
    MonotonicTime at;
  };
  void send(C3Ask ask, Now now, const DriverOut& out);
  void send_next(Now now, const DriverOut& out);

  std::deque<C3Ask> waiting_;           ///< the driver's own
  std::deque<C3Ask> requests_;          ///< members'
  std::map<std::uint16_t, Sent> sent_;  ///< by tag
  std::uint16_t last_tag_ = 0;
};

/// The robot has refused a request; the text names the variable and the value.
Error refused_by_robot(const C3Link::Answer& answer);

}  // namespace trb::drivers
