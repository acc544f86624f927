// session, me.
#include <algorithm>

#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/api/members.hpp"
#include "services/cloud-gateway/io/json_text.hpp"
#include "services/cloud-gateway/io/sign_ins.hpp"

namespace trb::gateway {
namespace {

void sign_in(Gateway& gateway, const CallPtr& call) {
  const auto body = Members::of(*call, {"user", "password"});
  if (!body) return call->fail(body.error());
  const auto user = body->text("user", kMaxUserName);
  if (!user) return call->fail(user.error());
  const auto password = body->text("password", kMaxPassword);
  if (!password) return call->fail(password.error());
  gateway.sign_ins->request(call, *user, *password);
}

void show_me(const Gateway& gateway, const CallPtr& call) {
  const User* user = gateway.access.users.find(call->who().name);
  if (user != nullptr && call->request.session) {
    return call->reply(json_reply(json_session(*user, Sessions::csrf_of(*call->request.session))));
  }
  JsonObject out;
  out.text("user", call->who().name).text("role", name_of(call->who().role));
  call->reply(json_reply(out.flag("read_only", call->who().read_only).done()));
}

void sign_out(Gateway& gateway, const CallPtr& call) {
  gateway.access.sessions.end(call->request.session.value_or(""));
  HttpReply out = empty_reply();
  out.headers.emplace_back("Set-Cookie",
                           std::string(kSessionCookie) + "=; Path=/; Secure; HttpOnly; SameSite=Strict; Max-Age=0");
  call->reply(std::move(out));
}

void sign_out_everywhere(Gateway& gateway, const CallPtr& call) {
  gateway.access.sessions.end_all_of(call->who().name);
  call->reply(empty_reply());
}

/// The password is hashed on the pool; the user may be gone when that is done, or an admin has set another one.
void set_own_password(Gateway& gateway, const CallPtr& call, std::string password) {
  gateway.passwords.hash(std::move(password), [&gateway, call](const std::string& hash) {
    if (hash.empty()) return call->reply(problem_reply(503, "unavailable", "no memory for the hash", "try again"));
    if (!is_still_allowed(gateway, call)) return;
    const Status set = gateway.access.users.set_password(call->who().name, hash);
    if (!set) return call->fail(set.error());
    call->reply(empty_reply());
  });
}

void on_old_password(Gateway& gateway, const CallPtr& call, const Attempt& attempt, CheckResult result,
                     const std::string& password) {
  if (result == CheckResult::failed) {
    gateway.access.guard.cancel(attempt);
    return call->reply(problem_reply(503, "unavailable", "the password could not be checked", "try again"));
  }
  if (result == CheckResult::wrong) {
    return call->reply(problem_reply(403, "wrong_password", "the old password is wrong", "try again"));
  }
  gateway.access.guard.succeeded(attempt);
  set_own_password(gateway, call, password);
}

/// What check_new_password() calls "password" is "new" here.
Error as_member_new(Error error) {
  constexpr std::string_view kPassword = "password: ";
  if (error.what.starts_with(kPassword)) error.what.replace(0, kPassword.size(), "new: ");
  return error;
}

HttpReply wait_reply(Duration wait) {
  const auto s = std::max<std::int64_t>(std::chrono::ceil<std::chrono::seconds>(wait).count(), 1);
  HttpReply out = problem_reply(429, "wait", "too many wrong passwords", "try again in " + std::to_string(s) + " s");
  out.headers.emplace_back("Retry-After", std::to_string(s));
  return out;
}

/// Whoever has taken over a session must not guess its user's password here: wrong ones wait as at a sign-in.
void change_password(Gateway& gateway, const CallPtr& call) {
  const auto body = Members::of(*call, {"old", "new"});
  if (!body) return call->fail(body.error());
  const auto old = body->text("old", kMaxPassword);
  if (!old) return call->fail(old.error());
  const auto password = body->text("new", kMaxPassword);
  if (!password) return call->fail(password.error());
  const User* user = gateway.access.users.find(call->who().name);
  if (user == nullptr) return call->reply(problem_reply(404, "missing", "there is no such user", "sign in again"));
  if (Status good = check_new_password(user->name, *password); !good) return call->fail(as_member_new(good.error()));
  // Else the one that somebody else made, and may have seen, would count for good.
  if (*old == *password) return call->fail(fail(Errc::bad_value, "new: is the old password", "take another one"));
  const MonotonicTime now = gateway.now().mono;
  const Duration wait = gateway.access.guard.wait(user->name, call->request.source, now);
  if (wait > Duration::zero()) return call->reply(wait_reply(wait));
  const Attempt attempt = gateway.access.guard.begin(user->name, call->request.source, now);
  gateway.passwords.check({0, user->password_hash, *old},
                          [&gateway, call, attempt, password = *password](SignInId, CheckResult result) {
                            on_old_password(gateway, call, attempt, result, password);
                          });
}

}  // namespace

void add_session_routes(Gateway& gateway, HandlerTable& table) {
  table.add(Method::post, "/api/v1/session", [&](const CallPtr& call) { sign_in(gateway, call); });
  table.add(Method::get, "/api/v1/session", [&](const CallPtr& call) { show_me(gateway, call); });
  table.add(Method::delete_, "/api/v1/session", [&](const CallPtr& call) { sign_out(gateway, call); });
  table.add(Method::get, "/api/v1/me", [&](const CallPtr& call) { show_me(gateway, call); });
  table.add(Method::put, "/api/v1/me/password", [&](const CallPtr& call) { change_password(gateway, call); });
  table.add(Method::delete_, "/api/v1/me/sessions", [&](const CallPtr& call) { sign_out_everywhere(gateway, call); });
}

}  // namespace trb::gateway
