#include "proto/deadline.hpp"

#include <algorithm>
#include <array>

#include "proto/body.hpp"

namespace trb {
namespace {

bool ages(MessageType type, std::string_view subtype) {
  constexpr std::array kOrdered{Velocity::kSubtype, Release::kSubtype, TakeIntoUse::kSubtype, InjectFault::kSubtype,
                                RunSubmit::kSubtype};
  if (type != MessageType::command && type != MessageType::request) return false;
  return !is_typed(subtype) || std::ranges::find(kOrdered, subtype) != kOrdered.end();
}

}  // namespace

std::uint32_t remaining_after(Duration waited, MessageType type, std::string_view subtype, std::uint32_t remaining_ms) {
  if (waited <= Duration::zero() || !ages(type, subtype)) return remaining_ms;
  const auto ms = std::chrono::ceil<std::chrono::milliseconds>(waited).count();
  return ms >= remaining_ms ? 0 : remaining_ms - static_cast<std::uint32_t>(ms);
}

}  // namespace trb
