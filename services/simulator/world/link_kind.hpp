// What a network between two computers is like.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/time.hpp"

namespace trb::world {

struct LinkKind {
  std::string name;        ///< empty: of a file
  Duration delay{0};       ///< one way, mean
  Duration deviation{0};   ///< 0: the delay is constant
  std::uint32_t loss = 0;  ///< of a packet, in millionths: TCP sends it again, and what follows waits
  std::uint64_t bytes_a_second = 125'000'000;  ///< of one direction of a connection
  std::vector<Duration> measured{};            ///< one way; in place of delay and deviation: one of these by chance

  /// What nothing takes longer than, one way, while no packet is lost.
  [[nodiscard]] Duration longest() const {
    return measured.empty() ? delay + 6 * deviation : *std::ranges::max_element(measured);
  }
};

inline const std::array<LinkKind, 3> kLinkKinds{
    LinkKind{"lan", std::chrono::microseconds(200), Duration{0}, 0, 125'000'000},
    LinkKind{"wifi", std::chrono::milliseconds(3), std::chrono::milliseconds(1), 2'000, 3'000'000},
    LinkKind{"vpn", std::chrono::milliseconds(40), std::chrono::milliseconds(5), 1'000, 1'000'000}};

inline std::optional<LinkKind> find_link_kind(std::string_view name) {
  for (const LinkKind& kind : kLinkKinds) {
    if (kind.name == name) return kind;
  }
  return std::nullopt;
}

/// What ZMTP and CURVE add to a frame: 33 bytes of nonce, tag and name, and the length before them.
constexpr std::uint64_t on_wire(std::uint64_t frame) {
  constexpr std::uint64_t kCurve = 33, kShort = 255;
  return frame + kCurve + (frame + kCurve <= kShort ? 2 : 9);
}
constexpr std::uint64_t kConnectBytes = 867;  ///< both greetings, and CURVE's four messages
constexpr std::uint64_t kBeaconBytes = 56;    ///< a beacon's datagram beyond its content: key number, nonce, tag

}  // namespace trb::world
