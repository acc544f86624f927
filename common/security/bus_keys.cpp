#include "common/security/bus_keys.hpp"

#include "common/base/files.hpp"
#include "common/base/hex.hpp"
#include "common/security/node_keys.hpp"

namespace trb {
namespace {

constexpr std::size_t kKeySize = 32;

std::string path_of(const std::string& node_dir, std::string_view name, const char* ending) {
  return node_dir + "/keys/bus/" + std::string(name) + ending;
}

Status write_public(const std::string& node_dir, const std::string& name, const LinkKey& key) {
  return write_file(path_of(node_dir, name, ".pub"), to_hex(key.public_key) + "\n");
}

Status make_one(const std::string& node_dir, const std::string& name) {
  const bool secret = file_exists(path_of(node_dir, name, ".key"));
  if (file_exists(path_of(node_dir, name, ".pub"))) return Done{};
  if (secret) {
    auto key = load_bus_key(node_dir, name);
    return key ? write_public(node_dir, name, *key) : Status(key.error());
  }
  const LinkKey key = make_link_key();
  if (Status s = write_file(path_of(node_dir, name, ".key"), to_hex(key.secret_key) + "\n", 0600); !s) return s;
  return write_public(node_dir, name, key);
}

}  // namespace

Status make_bus_keys(const std::string& node_dir, const std::vector<std::string>& names) {
  for (const char* folder : {"/keys", "/keys/bus"}) {
    if (Status made = make_dir(node_dir + folder, 0700); !made) return made;
  }
  for (const std::string& name : names) {
    if (Status made = make_one(node_dir, name); !made) return made;
  }
  return Done{};
}

Result<LinkKey> load_bus_key(const std::string& node_dir, std::string_view name) {
  return read_link_key(path_of(node_dir, name, ".key"));
}

Result<Bytes> load_bus_public(const std::string& node_dir, std::string_view name) {
  const std::string path = path_of(node_dir, name, ".pub");
  auto text = read_file(path, 4096);
  if (!text)
    return fail(text.error().code, path + ": no such file", "run trb fleet request NODE_DIR, or copy it from the node");
  while (!text->empty() && text->back() == '\n') text->pop_back();
  auto key = from_hex(*text);
  if (key && key->size() == kKeySize) return key;
  return fail(Errc::malformed, path + ": not a key of 32 bytes", "copy it again, or remove it: trb up makes it anew");
}

void check_bus_keys(const std::string& node_dir, const std::vector<std::string>& names, ConfigFaults& faults) {
  for (const std::string& name : names) {
    const auto add = [&](const std::string& file, const Error& error) {
      if (error.code != Errc::missing) faults.push_back({"keys/bus/" + name + file, "", error.what, error.hint});
    };
    const auto secret = load_bus_key(node_dir, name);
    const auto shown = load_bus_public(node_dir, name);
    if (!secret) add(".key", secret.error());
    if (!shown) add(".pub", shown.error());
    if (!secret || !shown || secret->public_key == *shown) continue;
    add(".pub", fail(Errc::wrong_key, "is not the public half of " + name + ".key beside it",
                     "remove the one that is not meant; trb up makes the .pub anew"));
  }
}

}  // namespace trb
