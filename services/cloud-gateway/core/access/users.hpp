// The people who may sign in.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "common/security/user_name.hpp"
#include "services/cloud-gateway/core/access/change_list.hpp"
#include "services/cloud-gateway/core/access/hash.hpp"

namespace trb::gateway {

/// Each role includes those before it.
enum class UserRole : std::uint8_t { viewer = 0, operator_ = 1, admin = 2 };
constexpr auto enum_names(UserRole) {
  return std::array<std::string_view, 3>{"viewer", "operator", "admin"};
}

struct User {
  std::string name;
  UserRole role = UserRole::viewer;
  std::string password_hash;  ///< as the hasher made it, with its own parameters
  bool disabled = false;
  UtcTime since;
  Bytes stamp;               ///< new when role, password or `disabled` changes: sessions with another stamp end
  bool must_change = false;  ///< the password was made by somebody else: only another one gives the user's rights
  bool operator==(const User&) const = default;
};

/// A fleet has dozens of users; the bound keeps the load at the start small.
constexpr std::size_t kMaxUsers = 1000;
/// Longer ones are refused before they cost a hash.
constexpr std::size_t kMaxPassword = 256;
/// Without a second factor a short one can be guessed.
constexpr std::size_t kMinPassword = 12;

constexpr std::size_t kMinLetters = 5;  ///< different ones: "aaaaaaaaaaaa" is long, and the first guess

/// Errors: bad_value.
Status check_new_password(std::string_view user, std::string_view password);

/// Names, roles and hashes. Errors: bad_value, duplicate, missing (no such user), queue_full (no room), conflict (it is
/// the last admin). A call without effect is no error and no change.
class Users {
 public:
  explicit Users(RandomBytes random) : random_(std::move(random)) {}

  /// Takes a row from the store; adds no change.
  void restore(User user);

  /// `must_change`: the user has to take another password before anything else.
  Status add(const std::string& name, UserRole role, std::string password_hash, UtcTime now, bool must_change = false);
  Status set_role(const std::string& name, UserRole role);
  /// `must_change`: the user has to take another one before anything else.
  Status set_password(const std::string& name, std::string password_hash, bool must_change = false);
  Status set_disabled(const std::string& name, bool disabled);
  Status remove(const std::string& name);

  [[nodiscard]] const User* find(std::string_view name) const;
  [[nodiscard]] const std::map<std::string, User, std::less<>>& all() const { return users_; }
  std::vector<Change<User>> take_changes() { return changes_.take(); }

 private:
  static Error unknown(const std::string& name);
  [[nodiscard]] bool is_last_admin(const User& user) const;
  Status changed(User& user);

  RandomBytes random_;
  std::map<std::string, User, std::less<>> users_;
  ChangeList<User> changes_;
};

}  // namespace trb::gateway
