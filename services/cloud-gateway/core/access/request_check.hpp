// Decides whether a request may be served, and for whom.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/cloud-gateway/core/access/rights.hpp"
#include "services/cloud-gateway/core/access/sessions.hpp"
#include "services/cloud-gateway/core/access/tokens.hpp"

namespace trb::gateway {

/// The parts of a request that the check needs. A missing header is nullopt; the shell refuses repeated
/// headers.
struct RequestHead {
  std::string_view method;
  std::string_view target;
  std::string_view host;
  std::optional<std::string_view> session;  ///< from the cookie
  std::optional<std::string_view> bearer;   ///< from Authorization
  std::optional<std::string_view> origin;
  std::optional<std::string_view> csrf;
};

/// The user or token for whom a request is served.
struct Principal {
  std::string name;  ///< "ann", "token:exporter"; empty: nobody
  UserRole role = UserRole::viewer;
  Bytes session;           ///< the session's key, if a cookie was sent
  bool read_only = false;  ///< for a token: its WebSocket messages may change nothing either
};

enum class RequestVerdict : std::uint8_t {
  allowed,
  bad_path,              ///< 400
  two_identities,        ///< 400: a cookie and a token
  not_signed_in,         ///< 401
  wrong_host,            ///< 403, as all below
  wrong_origin,          ///< not from this gateway's own page
  wrong_csrf,            ///< no CSRF value, or not the session's
  password_must_change,  ///< somebody else made the user's password
  role_too_low,
  people_only,  ///< a token; only a user who has signed in may do this
  read_only_token,
  not_found,           ///< 404
  method_not_allowed,  ///< 405
};
/// Stable problem codes.
constexpr auto enum_names(RequestVerdict) {
  return std::array<std::string_view, 13>{
      "allowed",         "bad_path",   "two_identities",       "not_signed_in", "wrong_host",
      "wrong_origin",    "wrong_csrf", "password_must_change", "role_too_low",  "people_only",
      "read_only_token", "not_found",  "method_not_allowed"};
}
/// 200 for `allowed`.
int status_of(RequestVerdict verdict);

struct RequestDecision {
  RequestVerdict verdict = RequestVerdict::not_found;
  std::string hint;
  const Route* route = nullptr;  ///< set for every existing path and method, also if refused
  PathParameters parameters;
  Principal who;              ///< as soon as it is known
  std::vector<Method> allow;  ///< for method_not_allowed
};

/// Checks in this order; the first failure is the answer: path, route, host, identity, Origin, CSRF, a password that
/// must change, role, token limits. Routes are not secret, so a stranger gets 404 and 405 too; he never learns whether
/// an item exists.
class RequestCheck {
 public:
  /// `origins`: the addresses by which people reach this gateway, "https://hall.example:8443".
  RequestCheck(std::vector<std::string> origins, const Users& users, Sessions& sessions, const Tokens& tokens)
      : origins_(std::move(origins)), users_(users), sessions_(sessions), tokens_(tokens) {}

  /// `now`: steady UTC.
  RequestDecision check(const RequestHead& head, UtcTime now);

 private:
  RequestVerdict identify(const RequestHead& head, UtcTime now, RequestDecision& out);
  [[nodiscard]] bool is_own_host(const RequestHead& head) const;
  [[nodiscard]] bool is_own_origin(const RequestHead& head) const;
  [[nodiscard]] RequestVerdict check_forgery(const RequestHead& head, const RequestDecision& so_far) const;
  RequestVerdict decide(const RequestHead& head, UtcTime now, RequestDecision& out);

  std::vector<std::string> origins_;
  const Users& users_;
  Sessions& sessions_;
  const Tokens& tokens_;
};

}  // namespace trb::gateway
