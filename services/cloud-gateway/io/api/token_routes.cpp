// tokens.
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/api/members.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

constexpr std::int64_t kTokenDays = 90;
constexpr std::int64_t kMaxTokenDays = 365;
constexpr std::size_t kMaxTokenName = 64;

JsonObject json_token(const Token& token) {
  JsonObject out;
  out.text("name", token.name).text("role", name_of(token.role)).flag("read_only", token.read_only);
  out.text("made_by", token.made_by).time("made", token.made).time("ends", token.ends);
  return out;
}

void list_tokens(const Gateway& gateway, const CallPtr& call) {
  JsonList tokens;
  for (const auto& [name, token] : gateway.access.tokens.all()) tokens.add(json_token(token).done());
  call->reply(json_reply(JsonObject().raw("tokens", tokens.done()).done()));
}

Result<TokenWish> wish_of(const Call& call) {
  const auto body = Members::of(call, {"name", "role", "read_only", "days"});
  if (!body) return body.error();
  const auto name = body->text("name", kMaxTokenName);
  if (!name) return name.error();
  const auto role = body->one_of<UserRole>("role");
  if (!role) return role.error();
  const auto read_only = body->flag_or("read_only", false);
  if (!read_only) return read_only.error();
  const auto days = body->number_or("days", kTokenDays, 1, kMaxTokenDays);
  if (!days) return days.error();
  return TokenWish{*name, *role, *read_only, std::chrono::hours(24 * *days), call.who().name};
}

/// The secret is shown this once.
void make_token(Gateway& gateway, const CallPtr& call) {
  const auto wish = wish_of(*call);
  if (!wish) return call->fail(wish.error());
  call->about = wish->name + " " + std::string(name_of(wish->role)) + (wish->read_only ? " read_only" : "");
  const auto secret = gateway.access.tokens.make(*wish, gateway.steady());
  if (!secret) return call->fail(secret.error());
  const Token& token = gateway.access.tokens.all().at(wish->name);
  call->reply(json_reply(json_token(token).text("secret", *secret).done(), 201));
}

void revoke_token(Gateway& gateway, const CallPtr& call) {
  const Status revoked = gateway.access.tokens.revoke(call->parameter("token"));
  if (!revoked) return call->fail(revoked.error());
  call->reply(empty_reply());
}

}  // namespace

void add_token_routes(Gateway& gateway, HandlerTable& table) {
  table.add(Method::get, "/api/v1/tokens", [&](const CallPtr& call) { list_tokens(gateway, call); });
  table.add(Method::post, "/api/v1/tokens", [&](const CallPtr& call) { make_token(gateway, call); });
  table.add(Method::delete_, "/api/v1/tokens/{token}", [&](const CallPtr& call) { revoke_token(gateway, call); });
}

}  // namespace trb::gateway
