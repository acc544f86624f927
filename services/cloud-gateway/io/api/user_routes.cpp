// users.
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/api/members.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

std::string json_user(const User& user) {
  JsonObject out;
  out.text("name", user.name).text("role", name_of(user.role)).flag("disabled", user.disabled);
  return out.time("since", user.since).done();
}

void list_users(const Gateway& gateway, const CallPtr& call) {
  JsonList users;
  for (const auto& [name, user] : gateway.access.users.all()) users.add(json_user(user));
  call->reply(json_reply(JsonObject().raw("users", users.done()).done()));
}

void show_user(const Gateway& gateway, const CallPtr& call, int status = 200) {
  const User* user = gateway.access.users.find(call->parameter("user"));
  if (user == nullptr) return call->reply(problem_reply(404, "missing", "there is no such user", "GET /api/v1/users"));
  call->reply(json_reply(json_user(*user), status));
}

/// Checks the password and hashes it; `then` gets the hash, if the caller may still do this.
void hash_new_password(Gateway& gateway, const CallPtr& call, const std::string& user, std::string password,
                       std::function<Result<std::string>(const std::string& hash)> then) {
  if (Status good = check_new_password(user, password); !good) return call->fail(good.error());
  gateway.passwords.hash(std::move(password), [&gateway, call, then = std::move(then)](const std::string& hash) {
    if (hash.empty()) return call->reply(problem_reply(503, "unavailable", "no memory for the hash", "try again"));
    if (!is_still_allowed(gateway, call)) return;
    auto json = then(hash);
    if (!json) return call->fail(json.error());
    call->reply(json->empty() ? empty_reply() : json_reply(std::move(*json), 201));
  });
}

void add_user(Gateway& gateway, const CallPtr& call) {
  const auto body = Members::of(*call, {"name", "role", "password", "must_change"});
  if (!body) return call->fail(body.error());
  const auto name = body->text("name", kMaxUserName);
  if (!name) return call->fail(name.error());
  const auto role = body->one_of<UserRole>("role");
  if (!role) return call->fail(role.error());
  call->about = *name + " " + std::string(name_of(*role));
  const auto password = body->text("password", kMaxPassword);
  if (!password) return call->fail(password.error());
  const auto must = body->flag_or("must_change", false);
  if (!must) return call->fail(must.error());
  hash_new_password(
      gateway, call, *name, *password,
      [&gateway, name = *name, role = *role, must = *must](const std::string& hash) -> Result<std::string> {
        const Status added = gateway.access.users.add(name, role, hash, gateway.now().utc, must);
        if (!added) return added.error();
        return json_user(*gateway.access.users.find(name));
      });
}

/// For the audit log: "viewer disabled".
std::string change_in_words(std::optional<UserRole> role, std::optional<bool> disabled) {
  std::string out = role ? std::string(name_of(*role)) : "";
  if (disabled) out += std::string(out.empty() ? "" : " ") + (*disabled ? "disabled" : "enabled");
  return out;
}

void change_user(Gateway& gateway, const CallPtr& call) {
  const auto body = Members::of(*call, {"role", "disabled"});
  if (!body) return call->fail(body.error());
  const std::string& name = call->parameter("user");
  const auto disabled = body->flag_or("disabled", false);
  if (!disabled) return call->fail(disabled.error());
  std::optional<UserRole> role;
  if (body->has("role")) {
    const auto given = body->one_of<UserRole>("role");
    if (!given) return call->fail(given.error());
    role = *given;
  }
  call->about = change_in_words(role, body->has("disabled") ? std::optional(*disabled) : std::nullopt);
  if (role) {
    if (Status set = gateway.access.users.set_role(name, *role); !set) return call->fail(set.error());
  }
  if (body->has("disabled")) {
    if (Status set = gateway.access.users.set_disabled(name, *disabled); !set) return call->fail(set.error());
  }
  show_user(gateway, call);
}

void set_user_password(Gateway& gateway, const CallPtr& call) {
  const auto body = Members::of(*call, {"password", "must_change"});
  if (!body) return call->fail(body.error());
  const auto password = body->text("password", kMaxPassword);
  if (!password) return call->fail(password.error());
  const auto must = body->flag_or("must_change", false);
  if (!must) return call->fail(must.error());
  const std::string& name = call->parameter("user");
  hash_new_password(gateway, call, name, *password,
                    [&gateway, name, must = *must](const std::string& hash) -> Result<std::string> {
                      const Status set = gateway.access.users.set_password(name, hash, must);
                      return set ? Result<std::string>("") : set.error();
                    });
}

void remove_user(Gateway& gateway, const CallPtr& call) {
  const std::string& name = call->parameter("user");
  if (Status removed = gateway.access.users.remove(name); !removed) return call->fail(removed.error());
  gateway.access.guard.forget_user(name);
  call->reply(empty_reply());
}

}  // namespace

void add_user_routes(Gateway& gateway, HandlerTable& table) {
  table.add(Method::get, "/api/v1/users", [&](const CallPtr& call) { list_users(gateway, call); });
  table.add(Method::post, "/api/v1/users", [&](const CallPtr& call) { add_user(gateway, call); });
  table.add(Method::get, "/api/v1/users/{user}", [&](const CallPtr& call) { show_user(gateway, call); });
  table.add(Method::patch, "/api/v1/users/{user}", [&](const CallPtr& call) { change_user(gateway, call); });
  table.add(Method::put, "/api/v1/users/{user}/password",
            [&](const CallPtr& call) { set_user_password(gateway, call); });
  table.add(Method::delete_, "/api/v1/users/{user}", [&](const CallPtr& call) { remove_user(gateway, call); });
}

}  // namespace trb::gateway
