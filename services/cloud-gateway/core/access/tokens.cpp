#include "services/cloud-gateway/core/access/tokens.hpp"

#include "common/security/keys.hpp"

namespace trb::gateway {
namespace {

Bytes token_key(std::string_view secret) {
  return purpose_digest("gateway_token", secret);
}

}  // namespace

void Tokens::restore(Token token) {
  forget(token.name);
  names_[token.key] = token.name;
  std::string name = token.name;
  tokens_.emplace(std::move(name), std::move(token));
}

Result<std::string> Tokens::make(const TokenWish& wish, UtcTime now) {
  if (Status fits = check(wish); !fits) return fits.error();
  if (tokens_.size() >= kMaxTokens) drop_ended(now);
  if (tokens_.size() >= kMaxTokens) {
    return fail(Errc::queue_full, "there are " + std::to_string(kMaxTokens) + " tokens", "revoke one");
  }
  std::string secret = std::string(kTokenPrefix) + new_secret(random_);
  const Token token{wish.name, wish.role, wish.read_only, wish.made_by, now, now + wish.life, token_key(secret)};
  tokens_.emplace(wish.name, token);
  names_[token.key] = wish.name;
  changes_.put(wish.name, token);
  return secret;
}

Status Tokens::revoke(const std::string& name) {
  if (!tokens_.contains(name)) return fail(Errc::missing, "there is no token '" + name + "'", "GET /api/v1/tokens");
  drop(name);
  return Done{};
}

const Token* Tokens::find(std::string_view secret, UtcTime now) const {
  if (secret.size() != kTokenPrefix.size() + kSecretDigits || !secret.starts_with(kTokenPrefix)) return nullptr;
  const auto name = names_.find(token_key(secret));
  if (name == names_.end()) return nullptr;
  const Token& token = tokens_.at(name->second);
  return now < token.ends ? &token : nullptr;
}

void Tokens::move(const SteadyStep& step) {
  for (auto& [name, token] : tokens_) {
    if (!step.moves(token.made)) continue;
    token.made = step.moved(token.made);
    token.ends = token.ends + step.by;
    changes_.put(name, token);
  }
}

Status Tokens::check(const TokenWish& wish) const {
  if (!is_valid_user_name(wish.name)) {
    return fail(Errc::bad_value, "name: no name of a token",
                "begin with a lower-case letter, then lower-case letters, digits, '.', '_' or '-'; 32 at most");
  }
  if (wish.life <= Duration{0} || wish.life > kTokenLife)
    return fail(Errc::bad_value, "ends: a token ends within a year", "give an end, 365 days from now at most");
  if (tokens_.contains(wish.name))
    return fail(Errc::duplicate, "token '" + wish.name + "' exists", "revoke it, or take another name");
  return Done{};
}

void Tokens::forget(const std::string& name) {
  const auto at = tokens_.find(name);
  if (at == tokens_.end()) return;
  names_.erase(at->second.key);
  tokens_.erase(at);
}

void Tokens::drop(const std::string& name) {
  forget(name);
  changes_.drop(name);
}

void Tokens::drop_ended(UtcTime now) {
  std::vector<std::string> ended;
  for (const auto& [name, token] : tokens_)
    if (now >= token.ends) ended.push_back(name);
  for (const std::string& name : ended) drop(name);
}

}  // namespace trb::gateway
