// Shared by the access tests: a clock that the test moves, and bytes that never repeat.
#pragma once

#include <doctest/doctest.h>

#include <string>

#include "services/cloud-gateway/core/access/sessions.hpp"
#include "services/cloud-gateway/core/access/tokens.hpp"

namespace trb::gateway {

struct Parts {
  static RandomBytes counted_bytes() {
    return [count = std::uint32_t{0}](std::size_t size) mutable {
      Bytes out(size, '\x5a');
      ++count;
      for (std::size_t i = 0; i < 4 && i < size; ++i) out[i] = static_cast<char>(count >> (8 * i));
      return out;
    };
  }

  void pass(Duration by) {
    now.mono = now.mono + by;
    now.utc = now.utc + by;
  }
  const User& add(const std::string& name, UserRole role = UserRole::viewer) {
    REQUIRE(users.add(name, role, "hash of " + name, now.utc));
    return *users.find(name);
  }
  std::string sign_in(const std::string& name) { return sessions.open(*users.find(name), now.utc).id; }
  bool is_open(const std::string& id) { return sessions.find(id, users, now.utc) != nullptr; }

  Now now{{std::chrono::nanoseconds(std::chrono::hours(1)).count()}, {1'800'000'000'000'000'000}};
  RandomBytes random = counted_bytes();
  Users users{random};
  Sessions sessions{random};
  Tokens tokens{random};
};

/// A route's pattern with a value for each parameter.
inline std::string filled(std::string_view pattern) {
  std::string out(pattern);
  for (std::size_t at = out.find('{'); at != std::string::npos; at = out.find('{'))
    out.replace(at, out.find('}') - at + 1, "value-1");
  return out;
}

}  // namespace trb::gateway
