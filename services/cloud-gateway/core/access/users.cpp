#include "services/cloud-gateway/core/access/users.hpp"

#include <algorithm>
#include <set>

namespace trb::gateway {
namespace {

constexpr std::size_t kStampBytes = 16;

Error last_admin(const std::string& name) {
  return fail(Errc::conflict, "user '" + name + "' is the last admin that is not disabled",
              "make another user an admin first");
}

}  // namespace

Status check_new_password(std::string_view user, std::string_view password) {
  if (password.size() < kMinPassword)
    return fail(Errc::bad_value, "password: shorter than 12 bytes", "take a few words");
  if (password.size() > kMaxPassword) return fail(Errc::bad_value, "password: over 256 bytes", "take a shorter one");
  if (!user.empty() && password.find(user) != std::string_view::npos && password.size() - user.size() < kMinPassword)
    return fail(Errc::bad_value, "password: little more than the user's name", "take a few words");
  if (std::set<char>(password.begin(), password.end()).size() < kMinLetters)
    return fail(Errc::bad_value, "password: fewer than five different letters", "take a few words");
  return Done{};
}

void Users::restore(User user) {
  std::string name = user.name;
  users_.insert_or_assign(std::move(name), std::move(user));
}

Status Users::add(const std::string& name, UserRole role, std::string password_hash, UtcTime now, bool must_change) {
  if (!is_valid_user_name(name)) {
    return fail(Errc::bad_value, "name: no name of a user", kUserNameHint);
  }
  if (password_hash.empty()) return fail(Errc::missing, "password of '" + name + "'");
  if (users_.contains(name)) return fail(Errc::duplicate, "user '" + name + "' exists", "take another name");
  if (users_.size() >= kMaxUsers) {
    return fail(Errc::queue_full, "there are " + std::to_string(kMaxUsers) + " users", "remove one who has left");
  }
  User& user = users_[name];
  user = {name, role, std::move(password_hash), false, now, {}, must_change};
  return changed(user);
}

Status Users::set_role(const std::string& name, UserRole role) {
  const auto at = users_.find(name);
  if (at == users_.end()) return unknown(name);
  if (at->second.role == role) return Done{};
  if (is_last_admin(at->second)) return last_admin(name);
  at->second.role = role;
  return changed(at->second);
}

Status Users::set_password(const std::string& name, std::string password_hash, bool must_change) {
  const auto at = users_.find(name);
  if (at == users_.end()) return unknown(name);
  if (password_hash.empty()) return fail(Errc::missing, "password of '" + name + "'");
  at->second.password_hash = std::move(password_hash);
  at->second.must_change = must_change;
  return changed(at->second);
}

Status Users::set_disabled(const std::string& name, bool disabled) {
  const auto at = users_.find(name);
  if (at == users_.end()) return unknown(name);
  if (at->second.disabled == disabled) return Done{};
  if (disabled && is_last_admin(at->second)) return last_admin(name);
  at->second.disabled = disabled;
  return changed(at->second);
}

Status Users::remove(const std::string& name) {
  const auto at = users_.find(name);
  if (at == users_.end()) return unknown(name);
  if (is_last_admin(at->second)) return last_admin(name);
  changes_.drop(name);  // first: the name may be the row's own
  users_.erase(at);
  return Done{};
}

const User* Users::find(std::string_view name) const {
  const auto at = users_.find(name);
  return at == users_.end() ? nullptr : &at->second;
}

Error Users::unknown(const std::string& name) {
  return fail(Errc::missing, "there is no user '" + name + "'", "the list of users has them all");
}

bool Users::is_last_admin(const User& user) const {
  const auto serves = [](const auto& row) { return row.second.role == UserRole::admin && !row.second.disabled; };
  return user.role == UserRole::admin && !user.disabled && std::ranges::count_if(users_, serves) == 1;
}

Status Users::changed(User& user) {
  user.stamp = random_(kStampBytes);
  changes_.put(user.name, user);
  return Done{};
}

}  // namespace trb::gateway
