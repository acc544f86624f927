// What libzmq keeps of one connection's messages whose last part has not come. It bounds the number of complete
// messages (RCVHWM) and the size of a part (MAXMSGSIZE), but not the number of parts, and nobody sees a message before
// its last part. So what was read of the connection is compared with what the loop received from it.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "common/base/on_wire.hpp"

namespace trb {

/// On a connection that carries messages: one of 1 MiB under way, one being decrypted, and small change (handshake,
/// libzmq's buffer).
constexpr std::uint64_t kMostIncomplete = 3U << 20U;
/// Read in all on a connection that carries no messages yet: the handshake and a Hello of 4 kB.
constexpr std::uint64_t kMostUnproven = 64U << 10U;

/// state     | event                                         | next
/// ----------|-----------------------------------------------|------------------------------------------------------
/// calm      | look(): no more is missing than is usual      | calm
/// calm      | look(): more is missing                       | suspected: complete messages may wait for the loop
/// suspected | look() (repeated)                             | suspected, by the first look
/// suspected | on_empty(): the loop has received it meanwhile| calm
/// suspected | on_empty(): it is still missing (invalid)     | calm; the connection has to end
class IncompleteBytes {
 public:
  IncompleteBytes() = default;
  explicit IncompleteBytes(std::uint64_t most) : most_(most) {}

  /// The loop has received a frame of this size from the connection, whatever becomes of it.
  void add(std::uint64_t frame) { add_on_wire(on_wire(frame)); }
  /// The same, for frames that took this many bytes on the wire together.
  void add_on_wire(std::uint64_t bytes) { received_ += bytes; }
  /// `read`: bytes of the connection that have been read up to now, since it was made. True while suspected.
  bool look(std::uint64_t read) {
    if (!suspected_ && read > received_ + most_) suspected_ = read;
    return suspected_.has_value();
  }
  [[nodiscard]] bool is_suspected() const { return suspected_.has_value(); }
  /// The loop has received everything that was complete at the last look. True: too much is not.
  bool on_empty() {
    const auto read = std::exchange(suspected_, std::nullopt);
    return read && *read > received_ + most_;
  }

 private:
  std::uint64_t most_ = kMostIncomplete;
  std::uint64_t received_ = 0;
  std::optional<std::uint64_t> suspected_;  ///< what had been read at that look
};

}  // namespace trb
