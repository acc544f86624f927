// The lossy lane beside a link: each node publishes for its peers, and each peer receives only what is meant for it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/base/time.hpp"
#include "proto/message.hpp"

namespace trb::router {

/// Information that may be lost: it goes by the lane, and nobody is notified when it is dropped.
inline bool is_lossy(const HeaderView& header) {
  return header.type == MessageType::information && (header.flags & kFlagLossy) != 0;
}

/// The topic under which a node subscribes at its peers. The zero ends it: else a subscriber to "ur" would get "ur3",
/// too.
inline Bytes topic_of(std::string_view node) {
  return Bytes(node) + '\0';
}

/// How much lossy information a peer gets by its link, or by a relay, while it does not listen to the lane: a stream or
/// a picture now and then, no flood.
class Spare {
 public:
  static constexpr std::uint32_t kMessages = 20;      ///< in a second
  static constexpr std::size_t kBytes = 256U << 10U;  ///< in a second

  /// False if this second's bytes or messages are used up.
  bool take(std::size_t size, MonotonicTime now);

 private:
  std::uint32_t messages_ = 0;
  std::size_t bytes_ = 0;
  MonotonicTime end_;
};

}  // namespace trb::router
