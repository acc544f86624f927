#include "services/cloud-gateway/io/sign_ins.hpp"

#include "services/cloud-gateway/io/bootstrap.hpp"
#include "services/cloud-gateway/io/fresh.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

constexpr const char* kCookieTraits = "; Path=/; Secure; HttpOnly; SameSite=Strict";

HttpReply refusal_of(const SignInAnswer& answer) {
  const std::string code(name_of(answer.outcome));
  if (answer.outcome == SignInOutcome::refused) {
    return problem_reply(401, code, "name or password is wrong", "an admin can set a new password; trb cloud password");
  }
  const int status = answer.outcome == SignInOutcome::wait ? 429 : 503;
  HttpReply out =
      problem_reply(status, code, "no sign-in now", "try again in " + std::to_string(answer.retry_after_s) + " s");
  out.headers.emplace_back("Retry-After", std::to_string(answer.retry_after_s));
  return out;
}

}  // namespace

std::string json_session(const User& user, const std::string& csrf) {
  JsonObject out;
  out.text("user", user.name).text("role", name_of(user.role)).text("csrf", csrf);
  return out.flag("must_change_password", user.must_change).done();
}

void SignIns::request(const CallPtr& call, std::string user, std::string password) {
  // Somebody at the node's console may have made a password a moment ago.
  if (Status taken = take_bootstrap(gateway_); !taken) return fail_unwritten(gateway_, *call, taken.error());
  const SignInId id = ++last_;
  call->actor = user;
  calls_[id] = call;
  if (call->request.client != nullptr) call->request.client->on_left = [this, id] { leave(id); };
  SignInEffects effects;
  gateway_.access.sign_in.request(
      {id, std::move(user), std::move(password), call->request.source, call->request.session.value_or("")},
      {gateway_.now().mono, gateway_.steady()}, effects);
  carry_out(std::move(effects));
}

void SignIns::leave(SignInId id) {
  if (calls_.erase(id) == 0) return;
  SignInEffects effects;
  gateway_.access.sign_in.left(id, {gateway_.now().mono, gateway_.steady()}, effects);
  carry_out(std::move(effects));
}

void SignIns::tick() {
  SignInEffects effects;
  gateway_.access.sign_in.tick({gateway_.now().mono, gateway_.steady()}, effects);
  carry_out(std::move(effects));
}

void SignIns::carry_out(SignInEffects effects) {
  for (PasswordCheck& check : effects.checks) {
    gateway_.passwords.check(std::move(check), [this](SignInId id, CheckResult result) {
      SignInEffects after;
      gateway_.access.sign_in.checked(id, result, {gateway_.now().mono, gateway_.steady()}, after);
      carry_out(std::move(after));
    });
  }
  for (const SignInAnswer& one : effects.answers) answer(one);
}

void SignIns::answer(const SignInAnswer& answer) {
  const auto at = calls_.find(answer.id);
  if (at == calls_.end()) return;
  const CallPtr call = std::move(at->second);
  calls_.erase(at);
  if (!answer.session) return call->reply(refusal_of(answer));
  const Session* session = gateway_.access.sessions.find(answer.session->id, gateway_.access.users, gateway_.steady());
  const User* user = session == nullptr ? nullptr : gateway_.access.users.find(session->user);
  if (user == nullptr) return call->reply(problem_reply(503, "unavailable", "the session has ended", "try again"));
  HttpReply out = json_reply(json_session(*user, answer.session->csrf), 201);
  out.headers.emplace_back("Set-Cookie", std::string(kSessionCookie) + "=" + answer.session->id + kCookieTraits);
  call->reply(std::move(out));
}

}  // namespace trb::gateway
