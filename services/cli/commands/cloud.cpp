// cloud password: the first sign-in at a gateway, and the way back in.
#include "common/base/files.hpp"
#include "common/security/keys.hpp"
#include "common/security/password_hash.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/io/folder_owner.hpp"
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

int run_password(const Arguments& arguments) {
  init_crypto();
  const std::string& dir = arguments.words[0];
  const std::string user = arguments.get("--user", "admin");
  if (!file_exists(dir + "/node.json")) {
    return print_error(arguments, fail(Errc::missing, dir + ": no node.json", "give the folder of the cloud node"));
  }
  const std::string password = new_password();
  const std::string hash = hash_password(password);
  if (hash.empty()) {
    return print_error(arguments, fail(Errc::io_error, "no memory for a password's hash", "64 MB must be free"));
  }
  const Value json{Value::Object{{"user", Value{user}}, {"hash", Value{hash}}}};
  const std::string path = dir + "/keys/gateway.password";
  if (Status written = write_file(path, dump_json(json) + "\n"); !written)
    return print_error(arguments, written.error());
  give_keys_to_owner(dir);
  if (arguments.has("--json")) {
    print_json(Value{Value::Object{{"user", Value{user}}, {"password", Value{password}}}});
    return kGood;
  }
  print_line("user:     " + user);
  print_line("password: " + password);
  print_line("It is shown this once, and counts from the next sign-in on. Change it in the page: Account.");
  return kGood;
}

const std::vector<Command> kCloudCommands = {
    {{"cloud", "password"},
     {"cloud password NODE_DIR",
      "Makes a password for an admin of the cloud's gateway: for the first sign-in, or if nobody remembers one.\n"
      "There is none by default. Whoever can write to the node's folder can do this.",
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
