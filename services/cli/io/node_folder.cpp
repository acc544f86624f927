#include "services/cli/io/node_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include "common/base/descriptor.hpp"
#include "common/base/files.hpp"
#include "common/security/node_keys.hpp"
#include "common/supervisor/process.hpp"
#include "common/transport/loop.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

namespace fs = std::filesystem;

/// All of the folder's files, in one that is not there yet.
Status write_folder(const NewNode& node, const std::string& dir, const std::string& config) {
  if (Status made = make_private_dir(dir); !made) return made;
  if (Status made = make_dir(dir + "/robots", 0700); !made) return made;
  const std::string robot = "robots/" + std::string(node.kind.description);
  if (Status copied = copy_examples(config, {"commands.json", "profile.json", "places.json", robot}, dir); !copied)
    return copied;
  if (Status written = write_file(dir + "/node.json", node_json_of(node)); !written) return written;
  if (Status written = write_file(dir + "/network.json", network_json_of(node.fleet_side)); !written) return written;
  init_crypto();
  return make_request(dir, node.id, Role::robot);
}

Status write_folder(const NewCloud& cloud, const std::string& dir, const std::string& config) {
  if (Status made = make_private_dir(dir); !made) return made;
  // For the page's map, and for how far a robot is from its task.
  if (Status copied = copy_examples(config, {"places.json"}, dir); !copied) return copied;
  if (Status written = write_file(dir + "/node.json", node_json_of(cloud)); !written) return written;
  if (Status written = write_file(dir + "/network.json", network_json_of(cloud.fleet_side)); !written) return written;
  if (!cloud.page.empty()) {
    if (Status written = write_file(dir + "/cloud.json", cloud_json_of(cloud)); !written) return written;
  }
  init_crypto();
  return make_request(dir, cloud.id, Role::cloud);
}

}  // namespace

Result<std::string> config_dir() {
  const std::string programs = supervisor::program_dir();
  const char* named = std::getenv("TRB_CONFIG");
  const std::vector<std::string> places = named != nullptr
                                              ? std::vector<std::string>{named}
                                              : std::vector{programs + "/../share/talkrobots/config",
                                                            programs + "/../../config", programs + "/../../../config"};
  for (const std::string& place : places) {
    if (file_exists(place + "/commands.json")) return place;
  }
  return fail(Errc::missing, "the shipped examples (config/commands.json) are not found",
              "install the package talkrobots, or name their folder in TRB_CONFIG");
}

Status find_node_json(const std::string& dir, const std::string& hint) {
  const Status there = look_for(dir + "/node.json");
  if (there || there.error().code != Errc::missing) return there;
  return fail(Errc::missing, dir + ": no node.json there", hint);
}

Status copy_examples(const std::string& config, const std::vector<std::string>& names, const std::string& dir) {
  for (const std::string& name : names) {
    const auto text = read_file(config + "/" + name);
    if (!text) return text.error();
    if (Status written = write_file(dir + "/" + name, *text); !written) return written;
  }
  return Done{};
}

std::string plain_folder(const std::string& path) {
  const fs::path out = fs::path(path).lexically_normal();
  return out.has_filename() ? out.string() : out.parent_path().string();
}

namespace {

Error has_files(const std::string& dir) {
  return fail(Errc::conflict, dir + " is there already, with files in it",
              "name a new folder, or move this one away; a node's once it is down (trb down " + dir + ")");
}

Error not_made(const std::string& dir, const std::error_code& problem) {
  if (problem == std::errc::directory_not_empty || problem == std::errc::file_exists) return has_files(dir);
  return fail(Errc::io_error, dir + ": " + problem.message(), "name a folder in one that you may write");
}

/// Held as long as the folder is being made; the kernel lets go of it for whoever is killed.
Descriptor lock_folder(const std::string& path) {
  Descriptor folder(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  return folder && ::flock(folder.get(), LOCK_EX | LOCK_NB) == 0 ? std::move(folder) : Descriptor();
}

bool is_own_folder(const fs::path& path) {
  struct stat facts {};
  return ::lstat(path.c_str(), &facts) == 0 && S_ISDIR(facts.st_mode) && facts.st_uid == ::geteuid();
}

}  // namespace

std::vector<std::string> unfinished_folders(const std::string& path) {
  const fs::path dir = plain_folder(path);
  const std::string prefix = dir.filename().string() + std::string(kMakingBeside);
  std::vector<std::string> out;
  std::error_code problem;
  fs::directory_iterator at(dir.has_parent_path() ? dir.parent_path() : fs::path("."), problem);
  for (; !problem && at != fs::directory_iterator(); at.increment(problem)) {
    const std::string name = at->path().filename().string();
    const bool is_named_so = name.starts_with(prefix) && name.size() == prefix.size() + 6;
    if (is_named_so && is_own_folder(at->path()) && lock_folder(at->path())) out.push_back(at->path().string());
  }
  std::ranges::sort(out);
  return out;
}

std::string note_of_unfinished(const std::string& folder) {
  return folder + " was left by a call that was interrupted, and may hold private keys; remove it: rm -r " + folder;
}

Status make_whole_folder(const std::string& path, const std::function<Status(const std::string& making)>& write) {
  const std::string dir = plain_folder(path);
  std::error_code problem;
  if (fs::exists(dir, problem) && !fs::is_empty(dir, problem)) return has_files(dir);
  // The new one takes the place of the empty one, in which whoever types would then not be any more.
  if (fs::equivalent(dir, fs::current_path(problem), problem))
    return fail(Errc::conflict, path + " is the folder that you are in", "go up (cd ..), and name it from there");
  for (const std::string& left : unfinished_folders(dir)) print_problem("note: " + note_of_unfinished(left) + "\n");
  auto making = make_dir_beside(dir);
  if (!making) return making.error();
  const Descriptor held = lock_folder(*making);
  Status written = write(*making);
  if (written) fs::rename(*making, dir, problem);
  if (written && problem) written = not_made(dir, problem);
  if (!written) fs::remove_all(*making, problem);
  return written;
}

Status make_node_folder(const NewNode& node, const std::string& dir, const std::string& config) {
  return make_whole_folder(dir, [&](const std::string& making) { return write_folder(node, making, config); });
}

Status make_cloud_folder(const NewCloud& cloud, const std::string& dir, const std::string& config) {
  return make_whole_folder(dir, [&](const std::string& making) { return write_folder(cloud, making, config); });
}

}  // namespace trb::cli
