// The table of routes alone.
#include "services/cloud-gateway/core/access/rights.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "proto/field.hpp"
#include "services/cloud-gateway/core/access/path.hpp"
#include "services/cloud-gateway/core/access/test/gateway_parts.hpp"

using namespace trb;
using namespace trb::gateway;

namespace {

Match match(std::string_view method, std::string_view path) {
  return match_route(method, *split_path(path));
}

std::set<std::string> rows_with(bool (*fits)(const Route&)) {
  std::set<std::string> out;
  for (const Route& route : routes())
    if (fits(route)) out.insert(std::string(name_of(route.method)) + " " + std::string(route.path));
  return out;
}

}  // namespace

TEST_CASE("every row is found by its own path, and no two rows are the same") {
  std::set<std::string> seen;
  for (const Route& route : routes()) {
    CAPTURE(route.path);
    CHECK(match(name_of(route.method), filled(route.path)).route == &route);
    CHECK(seen.insert(std::string(name_of(route.method)) + filled(route.path)).second);
    CHECK((route.method != Method::get || route.effect != Effect::changes));
  }
}

TEST_CASE("every family of the API is there") {
  for (const char* family :
       {"session", "me",     "users",  "tokens",   "robots",   "places",  "messages",    "sensors", "scenarios",
        "runs",    "alerts", "policy", "criteria", "minimums", "archive", "ahp",         "nodes",   "services",
        "links",   "doctor", "audit",  "health",   "ready",    "live",    "openapi.json"}) {
    CAPTURE(family);
    const std::string start = std::string("/api/v1/") + family;
    CHECK(std::ranges::any_of(routes(),
                              [&](const Route& r) { return r.path == start || r.path.starts_with(start + "/"); }));
  }
  CHECK(match("GET", "/metrics").route != nullptr);
}

TEST_CASE("what anyone and what only an admin may is written out: a row that joins them is seen") {
  CHECK(rows_with([](const Route& r) { return r.least == Least::anyone; }) ==
        std::set<std::string>{"GET /api/v1/health", "GET /api/v1/ready", "GET /api/v1/openapi.json", "GET /",
                              "GET /favicon.svg", "GET /assets/{file}", "POST /api/v1/session"});
  CHECK(rows_with([](const Route& r) { return r.least == Least::admin && !r.people_only; }) ==
        std::set<std::string>{"PUT /api/v1/policy", "PUT /api/v1/criteria", "PUT /api/v1/minimums", "GET /api/v1/users",
                              "GET /api/v1/users/{user}", "GET /api/v1/tokens", "GET /api/v1/audit",
                              "GET /api/v1/audit/export", "GET /api/v1/audit/head"});
  CHECK(rows_with([](const Route& r) { return r.people_only; }) ==
        std::set<std::string>{"DELETE /api/v1/session", "PUT /api/v1/me/password", "DELETE /api/v1/me/sessions",
                              "POST /api/v1/users", "PATCH /api/v1/users/{user}", "DELETE /api/v1/users/{user}",
                              "PUT /api/v1/users/{user}/password", "POST /api/v1/tokens",
                              "DELETE /api/v1/tokens/{token}"});
}

TEST_CASE("a viewer changes nothing but his own, and what is sent without changing anything is written out") {
  CHECK(rows_with([](const Route& r) { return r.effect == Effect::changes && r.least == Least::viewer; }) ==
        std::set<std::string>{"DELETE /api/v1/session", "PUT /api/v1/me/password", "DELETE /api/v1/me/sessions"});
  CHECK(rows_with([](const Route& r) { return r.effect == Effect::reads && r.method != Method::get; }) ==
        std::set<std::string>{"POST /api/v1/scenarios/check", "POST /api/v1/ahp"});
  CHECK(rows_with([](const Route& r) { return r.effect == Effect::upgrades; }) ==
        std::set<std::string>{"GET /api/v1/live"});
}

TEST_CASE("no two rows of one method fit one path: which of them is meant is no matter of their order") {
  const auto overlap = [](std::string_view a, std::string_view b) {
    const auto first = *split_path(filled(a));
    const auto second = *split_path(filled(b));
    return std::ranges::equal(first, second, [](const std::string& x, const std::string& y) {
      return x == y || x == "value-1" || y == "value-1";
    });
  };
  for (const Route& a : routes())
    for (const Route& b : routes()) CHECK((&a == &b || a.method != b.method || !overlap(a.path, b.path)));
}

TEST_CASE("parameters have their names; a method tells a path that is written out from one with a parameter") {
  const Match task = match("POST", "/api/v1/runs/run-7/tasks/weld/retry");
  REQUIRE(task.route != nullptr);
  CHECK(task.parameters == PathParameters{{"run", "run-7"}, {"task", "weld"}});
  CHECK(match("POST", "/api/v1/scenarios/check").parameters.empty());
  CHECK(match("GET", "/api/v1/scenarios/check").parameters == PathParameters{{"scenario", "check"}});
  CHECK(match("HEAD", "/api/v1/robots/arm").route == match("GET", "/api/v1/robots/arm").route);
}

TEST_CASE("a wrong method is told the right ones; a path that is not there has none") {
  const Match wrong = match("DELETE", "/api/v1/robots");
  CHECK(wrong.route == nullptr);
  CHECK(wrong.others == std::vector<Method>{Method::get});
  CHECK(match("POST", "/api/v1/users/ann").others.size() == 3);
  for (const char* method : {"get", "OPTIONS", "TRACE", "CONNECT", "", "GET "}) {
    CHECK(match(method, "/api/v1/robots").route == nullptr);
    CHECK_FALSE(match(method, "/api/v1/robots").others.empty());
  }
  for (const char* path : {"/api", "/api/v1", "/api/v2/robots", "/API/v1/robots", "/api/v1/robots/a/b/c", "/robots",
                           "/api/v1/robot", "/metrics/x", "/index.html", "/assets", "/assets/a/b", "/favicon.ico"})
    CHECK(match("GET", path).others.empty());
}
