// Bearer tokens: how a machine signs in.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "services/cloud-gateway/core/access/users.hpp"

namespace trb::gateway {

struct Token {
  std::string name;
  UserRole role = UserRole::viewer;
  bool read_only = false;  ///< may change nothing, whatever its role sees
  std::string made_by;
  UtcTime made;
  UtcTime ends;
  Bytes key;  ///< hash of the secret
};

struct TokenWish {
  std::string name;
  UserRole role = UserRole::viewer;
  bool read_only = false;
  Duration life{};
  std::string made_by;
};

/// What a secret begins with: who searches files for leaked ones finds it.
constexpr std::string_view kTokenPrefix = "trb_";
/// A machine's token is renewed once a year at least, else one that leaked is good for ever.
constexpr Duration kTokenLife = std::chrono::hours(24 * 365);
constexpr std::size_t kMaxTokens = 256;

/// -     | made                | valid; the secret is told once
/// valid | its end comes       | over, still listed: its name is not free
/// valid | revoked             | gone
/// over  | revoked, or its room is needed | gone
/// A token is the machine's and stays when the user leaves who made it. Times are steady UTC.
class Tokens {
 public:
  explicit Tokens(RandomBytes random) : random_(std::move(random)) {}

  /// As the store has it; tells no change.
  void restore(Token token);

  /// The secret, which is not kept. Errors: bad_value (name, life), duplicate, queue_full.
  Result<std::string> make(const TokenWish& wish, UtcTime now);
  /// Errors: missing.
  Status revoke(const std::string& name);
  /// The valid token of this secret. Hashed first, as a session's id.
  [[nodiscard]] const Token* find(std::string_view secret, UtcTime now) const;

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
