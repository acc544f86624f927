#include "services/cloud-gateway/io/bootstrap.hpp"

#include <filesystem>

#include "common/base/files.hpp"
#include "proto/value.hpp"

namespace trb::gateway {
namespace {

Status make_admin(Users& users, const std::string& name, const std::string& hash, UtcTime now) {
  if (users.find(name) == nullptr) {
    if (Status added = users.add(name, UserRole::admin, hash, now); !added) return added;
  }
  if (Status set = users.set_password(name, hash, true); !set) return set;
  if (Status set = users.set_role(name, UserRole::admin); !set) return set;
  return users.set_disabled(name, false);
}

const std::string* text_in(const Value& json, std::string_view key) {
  const Value* found = json.find(key);
  return found != nullptr && found->is_text() ? &found->text() : nullptr;
}

}  // namespace

Status take_bootstrap(Gateway& gateway) {
  const std::string path = gateway.node_dir + "/keys/gateway.password";
  if (!file_exists(path)) return Done{};
  const auto text = read_file(path, 4096);
  if (!text) return text.error();
  const auto json = parse_json(*text);
  const std::string* user = json ? text_in(*json, "user") : nullptr;
  const std::string* hash = json ? text_in(*json, "hash") : nullptr;
  if (user == nullptr || hash == nullptr) {
    return fail(Errc::malformed, path + ": no user and hash", "make it anew: trb cloud password NODE_DIR");
  }
  if (Status made = make_admin(gateway.access.users, *user, *hash, gateway.now().utc); !made) return made;
  if (Status written = gateway.commit(); !written) return written;
  std::error_code left;
  std::filesystem::remove(path, left);
  return left ? Status(fail(Errc::io_error, path + ": " + left.message(), "remove it by hand")) : Status(Done{});
}

}  // namespace trb::gateway
