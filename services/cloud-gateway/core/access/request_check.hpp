// Whether a request may be served, and as whose.
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

/// The parts of a request that decide. A header that is not there is nothing; one that is there twice the shell
/// refuses.
struct RequestHead {
  std::string_view method;
  std::string_view target;
  std::string_view host;
  std::optional<std::string_view> session;  ///< of the cookie
  std::optional<std::string_view> bearer;   ///< of Authorization
  std::optional<std::string_view> origin;
  std::optional<std::string_view> csrf;
};

/// As whom a request is served.
struct Principal {
  std::string name;  ///< "ann", "token:exporter"; empty: nobody
  UserRole role = UserRole::viewer;
  Bytes session;           ///< its key, for a cookie
  bool read_only = false;  ///< of a token: what comes later by a WebSocket may change nothing
};

enum class RequestVerdict : std::uint8_t {
  allowed,
  bad_path,        ///< 400
  two_identities,  ///< 400: a cookie and a token
  not_signed_in,   ///< 401
  wrong_host,      ///< 403, as all below
  wrong_origin,    ///< not from this gateway's own page
  wrong_csrf,      ///< no CSRF value, or not that of the session
  role_too_low,
  people_only,  ///< a token asks for what only who has signed in may
  read_only_token,
  not_found,           ///< 404
  method_not_allowed,  ///< 405
};
/// The stable codes of problems.
constexpr auto enum_names(RequestVerdict) {
  return std::array<std::string_view, 12>{"allowed",     "bad_path",        "two_identities", "not_signed_in",
                                          "wrong_host",  "wrong_origin",    "wrong_csrf",     "role_too_low",
                                          "people_only", "read_only_token", "not_found",      "method_not_allowed"};
}
/// 200 for `allowed`.
int status_of(RequestVerdict verdict);

struct RequestDecision {
  RequestVerdict verdict = RequestVerdict::not_found;
  std::string hint;
  const Route* route = nullptr;  ///< of every path and method that is there, also if it is refused
  PathParameters parameters;
  Principal who;              ///< as soon as it is known
  std::vector<Method> allow;  ///< of method_not_allowed
};

/// In this order, and the first that fails answers: path, route, host, identity, Origin, CSRF, role, what tokens may
/// not. The routes are no secret, so a stranger is told 404 and 405 too; whether a thing is there he is never told.
class RequestCheck {
 public:
  /// `origins`: by which addresses people reach this gateway, "https://hall.example:8443".
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
