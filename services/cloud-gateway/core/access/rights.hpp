// The routes of the API, and who may use each. There are no others.
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

/// The lowest role that may use a route.
enum class Least : std::uint8_t { anyone, viewer, operator_, admin };
constexpr bool suffices(UserRole role, Least least) {
  return static_cast<int>(role) + 1 >= static_cast<int>(least);
}

/// What a request does to the hall, its users or the gateway.
enum class Effect : std::uint8_t {
  reads,     ///< nothing
  changes,   ///< something: needs the CSRF value (cookie), refuses read-only tokens, is audited
  upgrades,  ///< becomes a WebSocket: Origin is checked as for a change
};

struct Route {
  Method method{};
  std::string_view path;  ///< "/api/v1/robots/{robot}": a parameter is in braces
  Least least = Least::admin;
  Effect effect = Effect::changes;
  bool people_only = false;  ///< no token: a leaked one must not create a token or a user that outlives it
};

std::span<const Route> routes();
/// A stop waits for nothing: not for the database either.
bool is_stop(const Route& route);

using PathParameters = std::map<std::string, std::string, std::less<>>;

/// The result of a route look-up. No two rows of one method match one path.
struct Match {
  const Route* route = nullptr;
  PathParameters parameters;
  std::vector<Method> others;  ///< without a route: the methods that this path has; empty: no such path
};
/// `method`: as in the request; HEAD uses the route of GET.
Match match_route(std::string_view method, std::span<const std::string> segments);

}  // namespace trb::gateway
