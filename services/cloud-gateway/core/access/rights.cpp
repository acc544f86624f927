#include "services/cloud-gateway/core/access/rights.hpp"

#include <algorithm>
#include <iterator>
#include <optional>

#include "proto/field.hpp"

namespace trb::gateway {
namespace {

using enum Method;
using enum Effect;
using enum Least;

constexpr Route kRoutes[] = {
    // Without a sign-in: for load balancers, other people's tools and the page before the sign-in.
    {get, "/api/v1/health", anyone, reads},
    {get, "/api/v1/ready", anyone, reads},
    {get, "/api/v1/openapi.json", anyone, reads},
    {get, "/", anyone, reads},
    {get, "/favicon.svg", anyone, reads},
    {get, "/assets/{file}", anyone, reads},
    {post, "/api/v1/session", anyone, changes},

    // The user's own account; last column: no tokens
    {get, "/api/v1/session", viewer, reads},
    {delete_, "/api/v1/session", viewer, changes, true},
    {get, "/api/v1/me", viewer, reads},
    {put, "/api/v1/me/password", viewer, changes, true},
    {delete_, "/api/v1/me/sessions", viewer, changes, true},

    {get, "/api/v1/users", admin, reads},
    {post, "/api/v1/users", admin, changes, true},
    {get, "/api/v1/users/{user}", admin, reads},
    {patch, "/api/v1/users/{user}", admin, changes, true},
    {put, "/api/v1/users/{user}/password", admin, changes, true},
    {delete_, "/api/v1/users/{user}", admin, changes, true},
    {get, "/api/v1/tokens", admin, reads},
    {post, "/api/v1/tokens", admin, changes, true},
    {delete_, "/api/v1/tokens/{token}", admin, changes, true},

    {get, "/api/v1/robots", viewer, reads},
    {get, "/api/v1/robots/{robot}", viewer, reads},
    {get, "/api/v1/robots/{robot}/history", viewer, reads},
    {get, "/api/v1/robots/{robot}/live", viewer, reads},
    {get, "/api/v1/robots/{robot}/skills", viewer, reads},
    {post, "/api/v1/robots/{robot}/stop", operator_, changes},
    {post, "/api/v1/robots/{robot}/release", operator_, changes},
    {post, "/api/v1/robots/{robot}/repaired", operator_, changes},
    {post, "/api/v1/robots/{robot}/retired", operator_, changes},
    {post, "/api/v1/robots/{robot}/returned", operator_, changes},
    {post, "/api/v1/stop", operator_, changes},
    {get, "/api/v1/places", viewer, reads},
    {get, "/api/v1/places/picture", viewer, reads},

    {get, "/api/v1/messages", viewer, reads},
    {post, "/api/v1/messages", operator_, changes},
    {post, "/api/v1/messages/requests", operator_, changes},

    {get, "/api/v1/sensors", viewer, reads},
    {get, "/api/v1/sensors/{node}/{sensor}", viewer, reads},
    {get, "/api/v1/sensors/{node}/{sensor}/value", viewer, reads},
    {get, "/api/v1/sensors/{node}/{sensor}/history", viewer, reads},
    {get, "/api/v1/sensors/{node}/{sensor}/history.csv", viewer, reads},

    // A check is computed here; a preflight sends requests to the robots.
    {get, "/api/v1/scenarios", viewer, reads},
    {post, "/api/v1/scenarios", operator_, changes},
    {post, "/api/v1/scenarios/check", viewer, reads},
    {post, "/api/v1/scenarios/preflight", operator_, changes},
    {post, "/api/v1/scenarios/import", operator_, changes},
    {get, "/api/v1/scenarios/{scenario}", viewer, reads},
    {put, "/api/v1/scenarios/{scenario}", operator_, changes},
    {delete_, "/api/v1/scenarios/{scenario}", operator_, changes},
    {get, "/api/v1/scenarios/{scenario}/export", viewer, reads},

    // Played in virtual time: the fleet hears nothing of it.
    {get, "/api/v1/simulations", viewer, reads},
    {post, "/api/v1/simulations", operator_, changes},
    {get, "/api/v1/simulations/{simulation}", viewer, reads},
    {delete_, "/api/v1/simulations/{simulation}", operator_, changes},

    {get, "/api/v1/runs", viewer, reads},
    {post, "/api/v1/runs", operator_, changes},
    {get, "/api/v1/runs/{run}", viewer, reads},
    {get, "/api/v1/runs/{run}/proof", viewer, reads},
    {post, "/api/v1/runs/{run}/pause", operator_, changes},
    {post, "/api/v1/runs/{run}/resume", operator_, changes},
    {post, "/api/v1/runs/{run}/abort", operator_, changes},
    {post, "/api/v1/runs/{run}/tasks/{task}/move", operator_, changes},
    {post, "/api/v1/runs/{run}/tasks/{task}/retry", operator_, changes},
    {post, "/api/v1/runs/{run}/tasks/{task}/skip", operator_, changes},

    // A ranking sends new requests to the robots.
    {get, "/api/v1/alerts", viewer, reads},
    {get, "/api/v1/alerts/{alert}", viewer, reads},
    {post, "/api/v1/alerts/{alert}/ranking", operator_, changes},
    {post, "/api/v1/alerts/{alert}/decision", operator_, changes},
    {post, "/api/v1/alerts/{alert}/acknowledge", operator_, changes},
    {post, "/api/v1/alerts/{alert}/shelve", operator_, changes},
    {post, "/api/v1/alerts/{alert}/unshelve", operator_, changes},
    {get, "/api/v1/policy", viewer, reads},
    {put, "/api/v1/policy", admin, changes},
    {get, "/api/v1/criteria", viewer, reads},
    {put, "/api/v1/criteria", admin, changes},
    {get, "/api/v1/minimums", viewer, reads},
    {put, "/api/v1/minimums", admin, changes},

    {get, "/api/v1/archive", viewer, reads},
    {get, "/api/v1/archive/{run}", viewer, reads},
    {post, "/api/v1/ahp", viewer, reads},

    // The doctor connects to addresses; the audit log has people's addresses.
    {get, "/api/v1/nodes", viewer, reads},
    {get, "/api/v1/nodes/{node}", viewer, reads},
    {get, "/api/v1/services", viewer, reads},
    {get, "/api/v1/links", viewer, reads},
    {get, "/api/v1/doctor", operator_, reads},
    {get, "/api/v1/audit", admin, reads},
    {get, "/api/v1/audit/export", admin, reads},
    {get, "/api/v1/audit/head", admin, reads},
    {get, "/metrics", viewer, reads},

    // Each topic has rights of its own, also for who may drive.
    {get, "/api/v1/live", viewer, upgrades},
};

bool is_parameter(std::string_view segment) {
  return segment.starts_with('{');
}

/// The next segment of a pattern; `rest` is what follows it.
std::string_view take_segment(std::string_view& rest) {
  rest.remove_prefix(1);
  const std::size_t end = std::min(rest.find('/'), rest.size());
  const std::string_view out = rest.substr(0, end);
  rest.remove_prefix(end);
  return out;
}

/// Most patterns do not match: nothing is copied for them.
bool fits(std::string_view pattern, std::span<const std::string> segments) {
  if (pattern == "/") pattern = {};  // no segment at all
  for (const std::string& segment : segments) {
    if (pattern.empty()) return false;
    pattern.remove_prefix(1);
    if (!pattern.starts_with('{') && !pattern.starts_with(segment)) return false;
    pattern.remove_prefix(pattern.starts_with('{') ? std::min(pattern.find('/'), pattern.size()) : segment.size());
    if (!pattern.empty() && pattern[0] != '/') return false;
  }
  return pattern.empty();
}

/// Of a pattern that fits.
PathParameters parameters_of(std::string_view pattern, std::span<const std::string> segments) {
  PathParameters out;
  for (const std::string& segment : segments) {
    const std::string_view expected = take_segment(pattern);
    if (is_parameter(expected)) out.emplace(expected.substr(1, expected.size() - 2), segment);
  }
  return out;
}

}  // namespace

bool is_stop(const Route& route) {
  return route.method == post && (route.path == "/api/v1/stop" || route.path == "/api/v1/robots/{robot}/stop");
}

std::span<const Route> routes() {
  return kRoutes;
}

Match match_route(std::string_view method, std::span<const std::string> segments) {
  if (method == "HEAD") method = name_of(get);
  for (const Route& route : kRoutes) {
    if (name_of(route.method) != method || !fits(route.path, segments)) continue;
    return {&route, parameters_of(route.path, segments), {}};
  }
  Match out;
  for (const Route& route : kRoutes) {
    if (fits(route.path, segments) && std::ranges::find(out.others, route.method) == out.others.end()) {
      out.others.push_back(route.method);
    }
  }
  return out;
}

}  // namespace trb::gateway
