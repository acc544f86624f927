// Requests by sender, origin and route, and the answer to each.
#include "services/cloud-gateway/core/access/request_check.hpp"

#include <set>

#include "proto/field.hpp"
#include "services/cloud-gateway/core/access/test/gateway_parts.hpp"

using namespace trb;
using namespace trb::gateway;

namespace {

constexpr const char* kHost = "hall.example:8443";
constexpr const char* kOrigin = "https://hall.example:8443";
constexpr const char* kAbort = "/api/v1/runs/run-7/abort";

struct Checked : Parts {
  RequestCheck check{{kOrigin, "https://127.0.0.1:8443"}, users, sessions, tokens};
  std::map<std::string, NewSession> ids;

  Checked() {
    for (const auto role : {UserRole::viewer, UserRole::operator_, UserRole::admin}) {
      const User& user = add(std::string(name_of(role)), role);
      ids[user.name] = sessions.open(user, now.utc);
    }
  }
  std::string token(UserRole role, bool read_only) {
    const std::string name = std::string(name_of(role)) + (read_only ? "-ro" : "");
    return *tokens.make({name, role, read_only, std::chrono::hours(1), "admin"}, now.utc);
  }
  /// A request as the page sends it.
  RequestHead page(const std::string& user, std::string_view method, std::string_view target) {
    const NewSession& own = ids.at(user);
    return {method, target, kHost, own.id, {}, kOrigin, own.csrf};
  }
  RequestVerdict verdict(const RequestHead& head) { return check.check(head, now.utc).verdict; }
};

}  // namespace

TEST_CASE("every row with nobody and with each role, by cookie and by token") {
  Checked checked;
  for (const Route& route : routes()) {
    const std::string path = filled(route.path);
    CAPTURE(path);
    const std::string_view method = name_of(route.method);
    const bool free = route.least == Least::anyone;
    const RequestHead nobody{method, path, kHost, {}, {}, kOrigin, {}};
    CHECK(checked.verdict(nobody) == (free ? RequestVerdict::allowed : RequestVerdict::not_signed_in));
    for (const auto role : {UserRole::viewer, UserRole::operator_, UserRole::admin}) {
      const int level = static_cast<int>(role) + 1;
      const bool may = level >= static_cast<int>(route.least);
      const auto expected = may ? RequestVerdict::allowed : RequestVerdict::role_too_low;
      CHECK(checked.verdict(checked.page(std::string(name_of(role)), method, path)) == expected);
    }
  }
}

TEST_CASE("a session that nobody has used for half an hour opens no route, and a token none after its end") {
  for (const Route& route : routes()) {
    Checked checked;
    const std::string secret = checked.token(UserRole::admin, false);
    const std::string path = filled(route.path);
    CAPTURE(path);
    const bool free = route.least == Least::anyone;
    const RequestHead by_page = checked.page("admin", name_of(route.method), path);
    const RequestHead by_token{name_of(route.method), path, kHost, {}, secret, {}, {}};
    const UtcTime session_over = checked.now.utc + std::chrono::minutes(30);
    const UtcTime token_over = checked.now.utc + std::chrono::hours(1);
    CHECK(checked.check.check(by_page, session_over).verdict ==
          (free ? RequestVerdict::allowed : RequestVerdict::not_signed_in));
    if (!free) CHECK(checked.check.check(by_token, token_over).verdict == RequestVerdict::not_signed_in);
  }
}

TEST_CASE("who has a password that somebody else made may take another one and stop robots, and nothing else") {
  Checked checked;
  REQUIRE(checked.users.set_password("admin", "hash", true));
  checked.ids["admin"] = checked.sessions.open(*checked.users.find("admin"), checked.now.utc);
  const std::string secret = checked.token(UserRole::admin, false);
  const std::set<std::string_view> free{"/api/v1/session", "/api/v1/me", "/api/v1/me/password", "/api/v1/me/sessions"};
  for (const Route& route : routes()) {
    const std::string path = filled(route.path);
    CAPTURE(path);
    const bool may = route.least == Least::anyone || free.contains(route.path) || is_stop(route);
    CHECK(checked.verdict(checked.page("admin", name_of(route.method), path)) ==
          (may ? RequestVerdict::allowed : RequestVerdict::password_must_change));
  }
  CHECK(checked.verdict({"GET", "/api/v1/users", kHost, {}, secret, {}, {}}) == RequestVerdict::allowed);
  REQUIRE(checked.users.set_password("admin", "own"));
  checked.ids["admin"] = checked.sessions.open(*checked.users.find("admin"), checked.now.utc);
  CHECK(checked.verdict(checked.page("admin", "GET", "/api/v1/users")) == RequestVerdict::allowed);
}

TEST_CASE(
    "every row with each token: it may what its role may, but for what people alone do, and read-only changes "
    "nothing") {
  Checked checked;
  for (const bool read_only : {false, true}) {
    for (const auto role : {UserRole::viewer, UserRole::operator_, UserRole::admin}) {
      const std::string secret = checked.token(role, read_only);
      for (const Route& route : routes()) {
        const std::string path = filled(route.path);
        CAPTURE(path);
        if (route.least == Least::anyone) continue;
        auto expected = RequestVerdict::allowed;
        if (read_only && route.effect == Effect::changes) expected = RequestVerdict::read_only_token;
        if (route.people_only) expected = RequestVerdict::people_only;
        if (static_cast<int>(role) + 1 < static_cast<int>(route.least)) expected = RequestVerdict::role_too_low;
        CHECK(checked.verdict({name_of(route.method), path, kHost, {}, secret, {}, {}}) == expected);
      }
    }
  }
}

TEST_CASE("who is allowed is told by name, role and session; a token by its own name") {
  Checked checked;
  const auto by_page = checked.check.check(checked.page("operator", "POST", kAbort), checked.now.utc);
  CHECK(by_page.who.name == "operator");
  CHECK(by_page.who.role == UserRole::operator_);
  CHECK(by_page.who.session.size() == 32);
  CHECK(by_page.parameters.at("run") == "run-7");
  CHECK(by_page.route->effect == Effect::changes);
  CHECK(status_of(by_page.verdict) == 200);
  const std::string secret = checked.token(UserRole::viewer, true);
  const auto by_token = checked.check.check({"GET", "/metrics", kHost, {}, secret, {}, {}}, checked.now.utc);
  CHECK(by_token.who.name == "token:viewer-ro");
  CHECK(by_token.who.read_only);
}

TEST_CASE("every refusal has a status, a stable code and a hint") {
  Checked checked;
  const auto refusal = [&](const RequestHead& head) {
    const auto decision = checked.check.check(head, checked.now.utc);
    CHECK_FALSE(decision.hint.empty());
    return std::pair{status_of(decision.verdict), std::string(name_of(decision.verdict))};
  };
  using Pair = std::pair<int, std::string>;
  const std::string secret = checked.token(UserRole::admin, false);
  const std::string read_only = checked.token(UserRole::admin, true);
  const auto& own = checked.ids.at("viewer");
  CHECK(refusal(checked.page("viewer", "GET", "/api/v1/../x")) == Pair{400, "bad_path"});
  CHECK(refusal({"GET", "/metrics", kHost, own.id, secret, {}, {}}) == Pair{400, "two_identities"});
  CHECK(refusal({"GET", "/metrics", kHost, {}, {}, {}, {}}) == Pair{401, "not_signed_in"});
  CHECK(refusal({"GET", "/metrics", "evil", own.id, {}, {}, {}}) == Pair{403, "wrong_host"});
  CHECK(refusal({"POST", kAbort, kHost, own.id, {}, "https://evil", own.csrf}) == Pair{403, "wrong_origin"});
  CHECK(refusal({"POST", kAbort, kHost, own.id, {}, kOrigin, {}}) == Pair{403, "wrong_csrf"});
  CHECK(refusal(checked.page("viewer", "POST", kAbort)) == Pair{403, "role_too_low"});
  CHECK(refusal({"POST", "/api/v1/tokens", kHost, {}, secret, {}, {}}) == Pair{403, "people_only"});
  CHECK(refusal({"POST", kAbort, kHost, {}, read_only, {}, {}}) == Pair{403, "read_only_token"});
  CHECK(refusal(checked.page("viewer", "GET", "/api/v1/nothing")) == Pair{404, "not_found"});
  CHECK(refusal(checked.page("viewer", "DELETE", "/api/v1/robots")) == Pair{405, "method_not_allowed"});
  CHECK(checked.check.check(checked.page("viewer", "PUT", "/api/v1/robots"), checked.now.utc).allow ==
        std::vector<Method>{Method::get});
}

TEST_CASE("given a cookie that is wrong, over, or of a user who was changed, then 401") {
  Checked checked;
  const auto me = [&](std::string_view id) { return checked.verdict({"GET", "/api/v1/me", kHost, id, {}, {}, {}}); };
  const std::string id = checked.ids.at("viewer").id;
  CHECK(me(id) == RequestVerdict::allowed);
  for (const std::string& wrong : {std::string(), std::string(64, 'a'), std::string(1 << 20, 'a'), id + " "})
    CHECK(me(wrong) == RequestVerdict::not_signed_in);
  REQUIRE(checked.users.set_role("viewer", UserRole::operator_));
  CHECK(me(id) == RequestVerdict::not_signed_in);
  checked.pass(kSessionIdle);
  CHECK(me(checked.ids.at("admin").id) == RequestVerdict::not_signed_in);
}

TEST_CASE("given a token that is wrong, over or revoked, then 401, also for who has no cookie at all") {
  Checked checked;
  const std::string secret = checked.token(UserRole::viewer, false);
  const auto me = [&](std::string_view bearer) {
    return checked.verdict({"GET", "/api/v1/me", kHost, {}, bearer, {}, {}});
  };
  CHECK(me(secret) == RequestVerdict::allowed);
  CHECK(me("trb_" + std::string(64, '0')) == RequestVerdict::not_signed_in);
  CHECK(me(checked.ids.at("admin").id) == RequestVerdict::not_signed_in);  // a session id is no token
  checked.pass(std::chrono::hours(1));
  CHECK(me(secret) == RequestVerdict::not_signed_in);
}

TEST_CASE("given a page of another site sends a change with the user's cookie, then it is refused by its Origin") {
  Checked checked;
  RequestHead head = checked.page("operator", "POST", kAbort);
  for (const char* origin : {"https://evil.example", "null", "", "http://hall.example:8443", "https://hall.example",
                             "https://hall.example:8443.evil", "https://127.0.0.1:8443", "hall.example:8443"}) {
    CAPTURE(origin);
    head.origin = origin;
    CHECK(checked.verdict(head) == RequestVerdict::wrong_origin);
  }
  head.origin.reset();
  CHECK(checked.verdict(head) == RequestVerdict::wrong_origin);
  head.origin = "HTTPS://Hall.Example:8443";
  CHECK(checked.verdict(head) == RequestVerdict::allowed);
}

TEST_CASE("sign-in and upgrade need the Origin too, and what is read does not") {
  Checked checked;
  CHECK(checked.verdict({"POST", "/api/v1/session", kHost, {}, {}, "https://evil", {}}) ==
        RequestVerdict::wrong_origin);
  CHECK(checked.verdict({"POST", "/api/v1/session", kHost, {}, {}, {}, {}}) == RequestVerdict::wrong_origin);
  CHECK(checked.verdict({"POST", "/api/v1/session", kHost, {}, "trb_x", {}, {}}) == RequestVerdict::wrong_origin);
  RequestHead live = checked.page("viewer", "GET", "/api/v1/live");
  live.csrf.reset();  // a browser's WebSocket cannot send the header
  CHECK(checked.verdict(live) == RequestVerdict::allowed);
  live.origin = "https://evil";
  CHECK(checked.verdict(live) == RequestVerdict::wrong_origin);
  live.origin.reset();
  CHECK(checked.verdict(live) == RequestVerdict::wrong_origin);
  RequestHead list = checked.page("viewer", "GET", "/api/v1/robots");
  list.origin.reset();
  list.csrf.reset();
  CHECK(checked.verdict(list) == RequestVerdict::allowed);
}

TEST_CASE("given a token, then no Origin is needed; but a browser's of another site is refused") {
  Checked checked;
  const std::string secret = checked.token(UserRole::operator_, false);
  CHECK(checked.verdict({"POST", kAbort, kHost, {}, secret, {}, {}}) == RequestVerdict::allowed);
  CHECK(checked.verdict({"POST", kAbort, kHost, {}, secret, "https://evil", {}}) == RequestVerdict::wrong_origin);
}

TEST_CASE("given a name that was bent to this address, then it is not served by it; health is") {
  Checked checked;
  RequestHead head = checked.page("operator", "POST", kAbort);
  head.host = "evil.example:8443";
  head.origin = "https://evil.example:8443";
  CHECK(checked.verdict(head) == RequestVerdict::wrong_host);
  CHECK(checked.verdict({"GET", "/api/v1/health", "10.0.0.1", {}, {}, {}, {}}) == RequestVerdict::allowed);
  head.host = "";
  head.origin = "";
  CHECK(checked.verdict(head) == RequestVerdict::wrong_host);
}

TEST_CASE("another's CSRF value does not pass") {
  Checked checked;
  RequestHead head = checked.page("operator", "POST", kAbort);
  head.csrf = checked.ids.at("admin").csrf;
  CHECK(checked.verdict(head) == RequestVerdict::wrong_csrf);
}

TEST_CASE(
    "given a stranger asks for what is not there or with a wrong method, then he learns no more than the API's "
    "document says") {
  Checked checked;
  const auto ask = [&](std::string_view method, std::string_view path) {
    return checked.verdict({method, path, kHost, {}, {}, {}, {}});
  };
  CHECK(ask("GET", "/api/v1/nothing") == RequestVerdict::not_found);
  CHECK(ask("GET", "/api/v1/robots/arm") == RequestVerdict::not_signed_in);
  CHECK(ask("GET", "/api/v1/robots/no-such-robot") == RequestVerdict::not_signed_in);
}
