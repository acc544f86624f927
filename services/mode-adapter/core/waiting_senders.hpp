// Which senders wait for an answer to a message that is on its way to the robot, or at it.
#pragma once

#include <map>
#include <optional>
#include <set>

#include "common/actor/inbound.hpp"
#include "common/base/time.hpp"
#include "services/mode-adapter/core/drivers.hpp"

namespace trb::adapter {

struct WaitingSender {
  Inbound message;  ///< without its data
  Driver* mode = nullptr;
  MonotonicTime deadline;
};

class WaitingSenders {
 public:
  static constexpr std::uint32_t kLongestMs = 10'000;

  /// How long its sender waits.
  [[nodiscard]] static double wait_s(const Inbound& message) {
    return std::min(message.remaining_ms, kLongestMs) / 1000.0;
  }
  [[nodiscard]] std::size_t size() const { return waiting_.size(); }
  void add(Token token, const Inbound& message, Driver& mode, Now now);
  std::optional<Inbound> take(Token token);
  /// The oldest request of that subtype from that source.
  std::optional<Inbound> take_answered(std::string_view subtype, std::string_view source);
  std::optional<std::pair<Token, WaitingSender>> take_expired(Now now);
  std::optional<Inbound> take_any_of(const Driver* mode);
  /// Makes room for one more of that source: the newest request of who has the most. None: that is this source itself.
  std::optional<std::pair<Token, WaitingSender>> take_for(const std::string& source);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  WaitingSender erase(std::map<Token, WaitingSender>::iterator at);

  std::map<Token, WaitingSender> waiting_;
  std::set<std::pair<MonotonicTime, Token>> deadlines_;  ///< read at every turn of the loop
};

}  // namespace trb::adapter
