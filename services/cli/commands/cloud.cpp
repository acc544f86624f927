// cloud password: the first sign-in at a gateway, and the way back in.
#include <algorithm>

#include "common/base/files.hpp"
#include "common/config/node_config.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/security/keys.hpp"
#include "common/security/password_hash.hpp"
#include "common/security/user_name.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/io/folder_owner.hpp"
#include "services/cli/io/node_folder.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

/// 100 bits in groups of five: no letter or digit that looks like another one.
std::string new_password() {
  constexpr std::string_view kLetters = "abcdefghjkmnpqrstuvwxyz23456789A";
  std::string out;
  for (const char byte : random_bytes(20)) {
    if (out.size() % 6 == 5) out += '-';
    out += kLetters[static_cast<unsigned char>(byte) % kLetters.size()];
  }
  return out;
}

/// Errors: missing (no node's folder), bad_value (a node without a gateway, no name of a user).
Status check_words(const std::string& dir, const std::vector<std::string>& services, const std::string& user) {
  constexpr const char* kFolder = "give the folder of the cloud node";
  if (Status there = find_node_json(dir, kFolder); !there) return there;
  if (std::ranges::find(services, "cloud-gateway") == services.end()) {
    return fail(Errc::bad_value, dir + R"(/node.json: "services" has no cloud-gateway: nobody signs in there)",
                std::string(kFolder) + ", or add cloud-gateway (trb node new --cloud NAME --page HOST:PORT makes one)");
  }
  if (is_valid_user_name(user)) return Done{};
  return fail(Errc::bad_value, "--user: " + in_quotes(user) + " is no name of a user", kUserNameHint);
}

/// Whose password was made before, and has not been taken by the gateway: the new one stands in its place. Empty:
/// nobody's.
std::string waiting_user(const std::string& path) {
  const auto text = read_file(path, 4096);
  const auto json = text ? parse_json(*text) : Result<Value>(text.error());
  const Value* user = json ? json->find("user") : nullptr;
  return user != nullptr && user->is_text() ? user->text() : "";
}

int run_password(const Arguments& arguments) {
  init_crypto();
  const std::string& dir = arguments.words[0];
  const std::string user = arguments.get("--user", "admin");
  const NodeCheck node = check_node_dir(dir, true);
  const bool unread = node.config.services.empty() && !node.faults.empty();
  const Status there = find_node_json(dir, "");
  if (unread && (there || there.error().code != Errc::missing)) return print_faults(arguments, node.faults);
  if (Status good = check_words(dir, node.config.services, user); !good) return print_error(arguments, good.error());
  const std::string password = new_password();
  const std::string hash = hash_password(password);
  if (hash.empty()) {
    return print_error(arguments, fail(Errc::io_error, "no memory for a password's hash", "64 MB must be free"));
  }
  const Value json{Value::Object{{"user", Value{user}}, {"hash", Value{hash}}}};
  const std::string path = dir + "/keys/gateway.password";
  const std::string before = waiting_user(path);
  if (Status written = write_file(path, dump_json(json) + "\n"); !written)
    return print_error(arguments, written.error());
  give_keys_to_owner(dir);
  if (arguments.has("--json")) {
    Value::Object out{{"user", Value{user}}, {"password", Value{password}}};
    if (!before.empty() && before != user) out.emplace_back("replaces", Value{before});
    print_json(Value{std::move(out)});
    return kGood;
  }
  print_line("user:     " + user);
  print_line("password: " + password);
  print_line(
      "It is shown this once, and counts from the next sign-in on; the page asks for a new one at the first sign-in.");
  print_line("note: whoever is '" + user +
             "' among the gateway's users is an enabled admin from then on; the audit log says so");
  if (!before.empty() && before != user)
    print_line("note: the password that was made for '" + before + "' before, and not used yet, counts no more");
  return kGood;
}

const std::vector<Command> kCloudCommands = {
    {{"cloud", "password"},
     {"cloud password NODE_DIR",
      "Makes a password for an admin of the cloud's gateway: for the first sign-in, or if nobody remembers one.\n"
      "There is none by default. Whoever can write to the node's folder can do this. A user who was a viewer, an\n"
      "operator, or disabled becomes an enabled admin by it; of those, an admin makes new passwords on the page.",
      {"--user NAME|whose (admin)", kJson},
      {"trb cloud password nodes/cloud"},
      1,
      1},
     run_password},
};

}  // namespace

std::vector<Command> cloud_commands() {
  return kCloudCommands;
}

}  // namespace trb::cli
