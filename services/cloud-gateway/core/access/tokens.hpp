// Bearer tokens: how a machine signs in.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/steady_time.hpp"
#include "services/cloud-gateway/core/access/users.hpp"

namespace trb::gateway {

struct Token {
  std::string name;
  UserRole role = UserRole::viewer;
  bool read_only = false;  ///< may change nothing, whatever its role
  std::string made_by;
  UtcTime made;
  UtcTime ends;
  Bytes key;  ///< hash of the secret
  bool operator==(const Token&) const = default;
};

struct TokenWish {
  std::string name;
  UserRole role = UserRole::viewer;
  bool read_only = false;
  Duration life{};
  std::string made_by;
};

/// Each secret begins with this, so that a scan for leaked secrets finds it.
constexpr std::string_view kTokenPrefix = "trb_";
/// A machine's token must be renewed once a year at least: else a leaked one is valid for ever.
constexpr Duration kTokenLife = std::chrono::hours(24 * 365);
constexpr std::size_t kMaxTokens = 256;

/// -     | made                | valid; the secret is shown once
/// valid | it expires          | over, still listed: its name is not free
/// valid | revoked             | gone
/// over  | revoked, or its room is needed | gone
/// A token belongs to the machine; it stays when the user who made it leaves. Times are steady UTC.
class Tokens {
 public:
  explicit Tokens(RandomBytes random) : random_(std::move(random)) {}

  /// Takes a row from the store; adds no change.
  void restore(Token token);

  /// Returns the secret, which is not kept. Errors: bad_value (name, life), duplicate, queue_full.
  Result<std::string> make(const TokenWish& wish, UtcTime now);
  /// Errors: missing.
  Status revoke(const std::string& name);
  /// The valid token with this secret; looked up by hash, like a session.
  [[nodiscard]] const Token* find(std::string_view secret, UtcTime now) const;
  /// The clock has stepped: a token lives for as long as was wished.
  void move(const SteadyStep& step);

  [[nodiscard]] const std::map<std::string, Token>& all() const { return tokens_; }
  std::vector<Change<Token>> take_changes() { return changes_.take(); }

 private:
  [[nodiscard]] Status check(const TokenWish& wish) const;
  void forget(const std::string& name);
  void drop(const std::string& name);
  void drop_ended(UtcTime now);

  RandomBytes random_;
  std::map<std::string, Token> tokens_;
  std::map<Bytes, std::string> names_;  ///< by key
  ChangeList<Token> changes_;
};

}  // namespace trb::gateway
