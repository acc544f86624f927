// The messages that have passed this node's router lately, and how many of each phase of Equation 12 since the start.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "proto/message.hpp"
#include "proto/phase.hpp"

namespace trb::gateway {

struct PassedMessage {
  std::uint64_t number = 0;  ///< 1, 2, 3 ...: of all that have passed
  UtcTime time;
  char direction = '=';  ///< '<' in, '>' out, '=' within the node
  CostPhase phase{};
  Message message;       ///< without its data, if that was too large to keep
  std::size_t size = 0;  ///< of its data
  [[nodiscard]] bool is_cut() const { return size != message.data.size(); }
};

struct MessageQuery {
  std::string node{};  ///< its source or target; empty: any
  std::string subtype{};
  std::optional<MessageType> type{};
  std::optional<CostPhase> phase{};  ///< empty: all but upkeep
  std::uint64_t before = std::numeric_limits<std::uint64_t>::max();
  std::size_t most = 100;
};

/// Bounded: the oldest go first. Upkeep has a room of its own, so that it does not push out what people look for.
class MessageLog {
 public:
  static constexpr std::size_t kMaxData = 16'384;  ///< kept of one message
  static constexpr std::size_t kMaxMessages = 2000;
  static constexpr std::size_t kMaxUpkeep = 500;
  static constexpr std::size_t kMaxBytes = 4U << 20U;  ///< in each room
  using PhaseCounts = std::array<std::uint64_t, enum_names(CostPhase{}).size()>;

  const PassedMessage& add(char direction, UtcTime time, const HeaderView& header);

  struct Found {
    std::vector<const PassedMessage*> messages;  ///< the newest first; valid until the next add()
    std::uint64_t next = 0;                      ///< `before` of the next page; 0: there is none
  };
  [[nodiscard]] Found find(const MessageQuery& query) const;
  [[nodiscard]] const PhaseCounts& counts() const { return counts_; }

 private:
  struct Room {
    std::size_t most = 0;
    std::deque<PassedMessage> messages{};
    std::size_t size = 0;
    const PassedMessage& add(PassedMessage message);
  };
  [[nodiscard]] const Room& room_of(const MessageQuery& query) const;

  Room work_{kMaxMessages};
  Room upkeep_{kMaxUpkeep};
  PhaseCounts counts_{};
  std::uint64_t last_ = 0;
};

}  // namespace trb::gateway
