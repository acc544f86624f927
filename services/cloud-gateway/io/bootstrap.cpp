#include "services/cloud-gateway/io/bootstrap.hpp"

#include <filesystem>

#include "common/base/files.hpp"
#include "proto/value.hpp"

namespace trb::gateway {
namespace {

/// What the user was not before: "admin", "enabled", both, or nothing but the password.
std::string what_changes(const User* user) {
  std::string out = "new password";
  if (user == nullptr) return out + ", new admin";
  if (user->role != UserRole::admin) out += ", admin (was " + std::string(name_of(user->role)) + ")";
  return out + (user->disabled ? ", enabled" : "");
}

Status make_admin(Users& users, const std::string& name, const std::string& hash, UtcTime now) {
  if (users.find(name) == nullptr) {
    if (Status added = users.add(name, UserRole::admin, hash, now); !added) return added;
  }
  if (Status set = users.set_password(name, hash, true); !set) return set;
  if (Status set = users.set_role(name, UserRole::admin); !set) return set;
  return users.set_disabled(name, false);
}

AuditRecord record_of_console(const std::string& user, const std::string& what, UtcTime now) {
  AuditRecord out;
  out.time = now.ns;
  out.who = "console";
  out.from = "the node's own";
  out.action = "trb cloud password";
  out.about = user + ": " + what;
  out.outcome = "done";
  return out;
}

const std::string* text_in(const Value& json, std::string_view key) {
  const Value* found = json.find(key);
  return found != nullptr && found->is_text() ? &found->text() : nullptr;
}

}  // namespace

Status take_bootstrap(Gateway& gateway) {
  const std::string path = gateway.node_dir + "/keys/gateway.password";
  // On a full disk it waits, like every change of a user; those that are known sign in meanwhile.
  if (gateway.access.unwritten()) return Done{};
  if (!file_exists(path)) return Done{};
  const auto text = read_file(path, 4096);
  if (!text) return text.error();
  const auto json = parse_json(*text);
  const std::string* user = json ? text_in(*json, "user") : nullptr;
  const std::string* hash = json ? text_in(*json, "hash") : nullptr;
  if (user == nullptr || hash == nullptr) {
    return fail(Errc::malformed, path + ": no user and hash", "make it anew: trb cloud password NODE_DIR");
  }
  const UtcTime now = gateway.now().utc;
  const std::string what = what_changes(gateway.access.users.find(*user));
  if (Status made = make_admin(gateway.access.users, *user, *hash, now); !made) return made;
  gateway.access.note(record_of_console(*user, what, now));
  if (Status written = gateway.commit(); !written) return written;
  std::error_code left;
  std::filesystem::remove(path, left);
  return left ? Status(fail(Errc::io_error, path + ": " + left.message(), "remove it by hand")) : Status(Done{});
}

}  // namespace trb::gateway
