// What a network between two simulated computers is like.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/time.hpp"

namespace trb::simulation {

struct LinkKind {
  std::string name;        ///< empty: described by the job
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

}  // namespace trb::simulation
