// What a sensor may be called.
#pragma once

#include <algorithm>
#include <string_view>

#include "common/base/ids.hpp"

namespace trb {

/// [A-Za-z_][A-Za-z0-9_]*, 64 at most: what may stand in a D-Bus interface and path, and in SensorInfo::name.
constexpr bool is_sensor_name(std::string_view name) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return !name.empty() && name.size() <= kMaxIdSize && is_letter(name.front()) &&
         std::ranges::all_of(name, [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); });
}

}  // namespace trb
