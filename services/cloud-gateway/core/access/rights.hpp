// The routes of the API, each with who may take it. What is not in this table is not there.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "services/cloud-gateway/core/access/users.hpp"

namespace trb::gateway {

enum class Method : std::uint8_t { get, post, put, patch, delete_ };
constexpr auto enum_names(Method) {
  return std::array<std::string_view, 5>{"GET", "POST", "PUT", "PATCH", "DELETE"};
}

/// The least that somebody has to be.
enum class Least : std::uint8_t { anyone, viewer, operator_, admin };
constexpr bool suffices(UserRole role, Least least) {
  return static_cast<int>(role) + 1 >= static_cast<int>(least);
}

/// What a request does to the hall, its people or the gateway.
enum class Effect : std::uint8_t {
  reads,     ///< nothing
  changes,   ///< something: CSRF value of a cookie's session, no read-only token, a record in the audit
  upgrades,  ///< becomes a WebSocket: Origin is checked as for a change
};

struct Route {
  Method method{};
  std::string_view path;  ///< "/api/v1/robots/{robot}": what stands in braces is a parameter
  Least least = Least::admin;
  Effect effect = Effect::changes;
  bool people_only = false;  ///< no token: one that leaked must not make another, or a user, that outlives it
};

std::span<const Route> routes();

using PathParameters = std::map<std::string, std::string, std::less<>>;

/// What became of a method and a path. No two rows of one method fit one path.
struct Match {
  const Route* route = nullptr;
  PathParameters parameters;
  std::vector<Method> others;  ///< without a route: the methods that this path has; none: there is no such path
};
/// `method` as the request has it; HEAD is answered as GET is.
Match match_route(std::string_view method, std::span<const std::string> segments);

}  // namespace trb::gateway
