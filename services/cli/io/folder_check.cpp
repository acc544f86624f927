#include "services/cli/io/folder_check.hpp"

#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <vector>

#include "common/base/disk_state.hpp"
#include "common/security/certificate_file.hpp"
#include "common/security/stored_updates.hpp"

namespace trb::cli {
namespace {

namespace fs = std::filesystem;

struct Entry {
  std::string path;  ///< within the node's folder
  struct stat facts {};
};

std::optional<struct stat> facts_of(const std::string& path) {
  struct stat facts {};
  return ::stat(path.c_str(), &facts) == 0 ? std::optional(facts) : std::nullopt;
}

/// What belongs to the user whose services run here: the folder, or what the services write in one of root's.
std::string owned(const std::string& dir) {
  const auto folder = facts_of(dir);
  const bool is_roots = folder && folder->st_uid == 0;
  return is_roots && facts_of(dir + "/state") ? dir + "/state" : dir;
}

uid_t owner_of(const std::string& dir) {
  const auto facts = facts_of(owned(dir));
  return facts ? facts->st_uid : ::geteuid();
}

std::string name_of_user(uid_t user) {
  const passwd* row = ::getpwuid(user);
  return row == nullptr ? "#" + std::to_string(user) : row->pw_name;
}

/// All below `top`, and itself.
void add_entries(const std::string& dir, const std::string& top, std::vector<Entry>& out) {
  const auto add = [&](const std::string& path) {
    if (const auto facts = facts_of(dir + "/" + path)) out.push_back({path, *facts});
  };
  add(top);
  std::error_code none;
  for (fs::recursive_directory_iterator at(dir + "/" + top, none), end; !none && at != end; at.increment(none)) {
    add(at->path().lexically_relative(dir).string());
  }
}

std::vector<Entry> entries_of(const std::string& dir, const std::vector<std::string>& tops) {
  std::vector<Entry> out;
  for (const std::string& top : tops) add_entries(dir, top, out);
  std::ranges::sort(out, {}, &Entry::path);
  return out;
}

/// "keys/link.key and 3 more"
std::string names(const std::vector<std::string>& paths) {
  return paths.front() + (paths.size() > 1 ? " and " + std::to_string(paths.size() - 1) + " more" : "");
}

void add_owners(const std::string& dir, ConfigFaults& faults) {
  const uid_t owner = owner_of(dir);
  std::vector<std::string> others;
  uid_t other = 0;
  for (const Entry& one : entries_of(dir, {"keys", "state"})) {
    const bool for_all = one.path.starts_with("keys") && (one.facts.st_mode & 0004U) != 0;
    if (one.facts.st_uid == owner || for_all) continue;
    if (others.empty()) other = one.facts.st_uid;
    others.push_back(one.path);
  }
  if (others.empty()) return;
  faults.push_back({others.front(), "",
                    names(others) + ": of " + name_of_user(other) + ", and the services run as " + name_of_user(owner),
                    "chown -R --reference=" + owned(dir) + " " + dir + "/keys " + dir + "/state"});
}

/// The group of the owner's own name has no other members.
bool others_may_write(const struct stat& facts) {
  if ((facts.st_mode & 0002U) != 0) return true;
  const passwd* row = ::getpwuid(facts.st_uid);
  return (facts.st_mode & 0020U) != 0 && (row == nullptr || row->pw_gid != facts.st_gid);
}

void add_rights(const std::string& dir, ConfigFaults& faults) {
  std::vector<std::string> tops{"keys", "state", "robots", "sensors"};
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(dir, none)) {
    if (entry.path().extension() == ".json") tops.push_back(entry.path().filename().string());
  }
  std::vector<std::string> open;
  const auto folder = facts_of(dir);
  if (folder && others_may_write(*folder)) open.emplace_back(".");
  for (const Entry& one : entries_of(dir, tops)) {
    if (others_may_write(one.facts)) open.push_back(one.path);
  }
  if (open.empty()) return;
  const std::string all = open.front() == "." ? dir : dir + "/" + open.front();
  faults.push_back({open.front(), "",
                    names(open) + ": other users may write there; who does can have the node start any program",
                    open.size() > 1 ? "chmod -R go-w " + dir : "chmod go-w " + all});
}

void add_updates(const std::string& dir, ConfigFaults& faults) {
  const auto own = read_certificate_file(dir + "/keys/certificate.json");
  if (!own) return;  // told with the keys
  const auto stored = read_stored_updates(dir, own->authority);
  const auto why = stored ? stored->damaged : std::optional(stored.error());
  if (!why) return;
  faults.push_back({"state", "", why->what, stored ? "start the node: it is written anew from its copy" : why->hint});
}

Error read_only_disk(const std::string& dir) {
  return fail(Errc::io_error, "the disk of " + dir + " can be read only: nothing can be started there",
              "look why (dmesg), then: mount -o remount,rw; Linux does this to a disk that fails");
}

void add_disk(const std::string& dir, ConfigFaults& faults) {
  const auto disk = disk_state(dir);
  if (!disk) return;
  if (disk->read_only) {
    const Error why = read_only_disk(dir);
    faults.push_back({"disk", "", why.what, why.hint});
  } else if (const Status room = takes_more(*disk, dir); !room) {
    faults.push_back({"disk", "", room.error().what, room.error().hint});
  }
}

}  // namespace

ConfigFaults check_folder(const std::string& node_dir) {
  ConfigFaults faults;
  add_disk(node_dir, faults);
  add_owners(node_dir, faults);
  add_rights(node_dir, faults);
  add_updates(node_dir, faults);
  for (ConfigFault& fault : faults) fault.may_wait = true;
  return faults;
}

Status may_start(const std::string& node_dir, bool bus_in_folder) {
  const auto disk = disk_state(node_dir);
  if (bus_in_folder && disk && disk->read_only) return read_only_disk(node_dir);
  const uid_t owner = owner_of(node_dir);
  if (::geteuid() != 0 || owner == 0) return Done{};
  return fail(Errc::not_permitted,
              node_dir + " is of " + name_of_user(owner) + ", and root would leave files there which it cannot read",
              "start it as that user: runuser -u " + name_of_user(owner) + " -- trb up " + node_dir);
}

}  // namespace trb::cli
