#include "services/cloud-gateway/core/access/request_check.hpp"

#include <algorithm>

#include "services/cloud-gateway/core/access/path.hpp"

namespace trb::gateway {
namespace {

constexpr std::string_view kTokenName = "token:";

struct VerdictRow {
  int status;
  std::string_view hint;
};

/// In the order of RequestVerdict.
constexpr VerdictRow kVerdicts[] = {
    {200, ""},
    {400, "take the paths of /api/v1/openapi.json as they are"},
    {400, "send either the cookie or the bearer token"},
    {401, "sign in by POST /api/v1/session, or send a bearer token that has not ended"},
    {403, "open the page by one of \"names\" in cloud.json, or add to them what you typed"},
    {403, "send it from the gateway's own page; a program takes a bearer token"},
    {403, "send the csrf value of GET /api/v1/session as X-CSRF-Token"},
    {403, "take a password of your own: PUT /api/v1/me/password"},
    {403, "ask an admin for the role that this needs"},
    {403, "sign in: a token may not do that"},
    {403, "make a token that is not read-only"},
    {404, "see /api/v1/openapi.json"},
    {405, "see Allow"},
};

/// "https://host:1" -> "host:1"
std::string_view authority_of(std::string_view origin) {
  const std::size_t at = origin.find("://");
  return at == std::string_view::npos ? std::string_view() : origin.substr(at + 3);
}

bool is_same_name(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::ranges::equal(a, b, {}, lower, lower);
}

/// What somebody may do whose password is another's: see who he is, take a password of his own, sign out; and stop
/// robots, which waits for nothing.
bool is_for_all_passwords(const Route& route) {
  return is_stop(route) || route.path == "/api/v1/session" || route.path == "/api/v1/me" ||
         route.path == "/api/v1/me/password" || route.path == "/api/v1/me/sessions";
}

RequestVerdict check_rights(const Route& route, const Principal& who, bool by_token) {
  if (route.least == Least::anyone) return RequestVerdict::allowed;
  if (!suffices(who.role, route.least)) return RequestVerdict::role_too_low;
  if (by_token && route.people_only) return RequestVerdict::people_only;
  return who.read_only && route.effect == Effect::changes ? RequestVerdict::read_only_token : RequestVerdict::allowed;
}

}  // namespace

int status_of(RequestVerdict verdict) {
  return kVerdicts[static_cast<std::size_t>(verdict)].status;
}

RequestDecision RequestCheck::check(const RequestHead& head, UtcTime now) {
  RequestDecision out;
  out.verdict = decide(head, now, out);
  out.hint = kVerdicts[static_cast<std::size_t>(out.verdict)].hint;
  return out;
}

RequestVerdict RequestCheck::decide(const RequestHead& head, UtcTime now, RequestDecision& out) {
  const auto segments = split_path(head.target);
  if (!segments) return RequestVerdict::bad_path;
  Match match = match_route(head.method, *segments);
  out.route = match.route;
  out.parameters = std::move(match.parameters);
  out.allow = std::move(match.others);
  if (out.route == nullptr) return out.allow.empty() ? RequestVerdict::not_found : RequestVerdict::method_not_allowed;
  // A load balancer may use any host name.
  const bool harmless = out.route->least == Least::anyone && out.route->effect == Effect::reads;
  if (harmless) return RequestVerdict::allowed;
  if (!is_own_host(head)) return RequestVerdict::wrong_host;
  if (const auto verdict = identify(head, now, out); verdict != RequestVerdict::allowed) return verdict;
  if (const auto verdict = check_forgery(head, out); verdict != RequestVerdict::allowed) return verdict;
  const User* user = out.who.session.empty() ? nullptr : users_.find(out.who.name);
  if (user != nullptr && user->must_change && !is_for_all_passwords(*out.route)) {
    return RequestVerdict::password_must_change;
  }
  return check_rights(*out.route, out.who, head.bearer.has_value());
}

RequestVerdict RequestCheck::identify(const RequestHead& head, UtcTime now, RequestDecision& out) {
  // A user who signs in may still have the cookie of an ended session.
  if (out.route->least == Least::anyone) return RequestVerdict::allowed;
  if (head.session && head.bearer) return RequestVerdict::two_identities;
  if (head.bearer) {
    const Token* token = tokens_.find(*head.bearer, now);
    if (token == nullptr) return RequestVerdict::not_signed_in;
    out.who = {std::string(kTokenName) + token->name, token->role, {}, token->read_only};
    return RequestVerdict::allowed;
  }
  const Session* session = head.session ? sessions_.find(*head.session, users_, now) : nullptr;
  if (session == nullptr) return RequestVerdict::not_signed_in;
  out.who = {session->user, users_.find(session->user)->role, session->key, false};
  return RequestVerdict::allowed;
}

bool RequestCheck::is_own_host(const RequestHead& head) const {
  return std::ranges::any_of(origins_,
                             [&](const std::string& own) { return is_same_name(authority_of(own), head.host); });
}

bool RequestCheck::is_own_origin(const RequestHead& head) const {
  // It must be the requested address: to the browser, a page of our other address is another site.
  return head.origin && is_same_name(authority_of(*head.origin), head.host) &&
         std::ranges::any_of(origins_, [&](const std::string& own) { return is_same_name(own, *head.origin); });
}

RequestVerdict RequestCheck::check_forgery(const RequestHead& head, const RequestDecision& so_far) const {
  const Route& route = *so_far.route;
  const bool plain = route.method == Method::get && route.effect == Effect::reads;
  // A browser sends Origin with all of these. A program with a token may omit it, but a wrong one is refused.
  const bool by_token = !so_far.who.name.empty() && so_far.who.session.empty();
  const bool must_say = !plain && !by_token;
  if ((must_say || (!plain && head.origin)) && !is_own_origin(head)) return RequestVerdict::wrong_origin;
  const bool by_cookie = !so_far.who.session.empty();
  if (by_cookie && route.effect == Effect::changes && !Sessions::is_csrf_of(*head.session, head.csrf.value_or("")))
    return RequestVerdict::wrong_csrf;
  return RequestVerdict::allowed;
}

}  // namespace trb::gateway
