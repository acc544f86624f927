#pragma once

namespace trb {

inline constexpr const char* kVersion = "0.1.0";

}  // namespace trb
