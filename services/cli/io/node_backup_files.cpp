#include "services/cli/io/node_backup_files.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>

#include "common/base/files.hpp"
#include "common/base/time.hpp"
#include "common/service/version.hpp"
#include "common/sqlite/sqlite_file.hpp"
#include "common/transport/loop.hpp"
#include "services/cli/io/node_folder.hpp"

namespace trb::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kGateway = "state/gateway.db";
constexpr const char* kDamaged = "take another backup, or remove state/gateway.db and make a first user again";

/// What a process that was killed has left beside the file goes into it.
Status close_gateway(const std::string& dir) {
  const std::string path = dir + "/" + kGateway;
  if (!file_exists(path)) return Done{};
  auto file = SqliteFile::open(path, kDamaged);
  return file ? (*file)->script("PRAGMA wal_checkpoint(TRUNCATE)") : Status(file.error());
}

/// Nobody is signed in on the new PC because he was so when the backup was made; a token may have been taken back
/// since. The gateway puts on record from when its users and its log are.
Status forget_sessions(const std::string& dir, std::int64_t made_s) {
  const std::string path = dir + "/" + kGateway;
  if (!file_exists(path)) return Done{};
  auto file = SqliteFile::open(path, kDamaged);
  if (!file) return file.error();
  return (*file)->transact([&] {
    if (Status done = (*file)->script("DELETE FROM sessions; DELETE FROM tokens"); !done) return done;
    return (*file)->run("INSERT OR REPLACE INTO meta(name, value) VALUES('restored', ?)", made_s * 1'000'000'000);
  });
}

/// Errors: bad_value, io_error.
Status add(const fs::directory_entry& entry, const std::string& path, NodeBackup& backup) {
  std::error_code problem;
  const fs::file_status is = entry.symlink_status(problem);
  if (problem) return fail(Errc::io_error, path + ": " + problem.message());
  if (is.type() == fs::file_type::symlink) {
    return fail(Errc::bad_value, path + ": is a link; a backup has plain files alone",
                "put what it leads to into its place");
  }
  if (is.type() != fs::file_type::regular) {
    return fail(Errc::bad_value, path + ": is no plain file (a pipe, a socket or a device); a backup has these alone",
                "remove it, or move it out of the folder");
  }
  if (backup.files.size() == kBackupFiles) return fail(Errc::too_large, path + ": one file too many", "remove some");
  auto bytes = read_file(entry.path().string(), kBackupBytes);
  if (!bytes && bytes.error().code == Errc::too_large) {
    return fail(Errc::too_large,
                path + ": over " + std::to_string(kBackupBytes >> 20U) + " MiB, as much as a backup has in all",
                "move it out of the folder, if the node does not need it");
  }
  if (!bytes) return bytes.error();
  backup.files.push_back({path, static_cast<unsigned>(is.permissions()) & 0755U, std::move(*bytes)});
  return Done{};
}

Status add_folder(const std::string& dir, NodeBackup& backup) {
  std::error_code problem;
  fs::recursive_directory_iterator at(dir, problem);
  for (; !problem && at != fs::recursive_directory_iterator(); at.increment(problem)) {
    const std::string path = at->path().lexically_relative(dir).string();
    const bool is_folder = !at->is_symlink() && at->is_directory();
    const bool may_have_kept = is_kept(path + "/x") || path == "state";
    if (is_folder && !may_have_kept) at.disable_recursion_pending();
    // A state/ that lies elsewhere is not left out in silence.
    if (is_folder || (!is_kept(path) && path != "state")) continue;
    if (Status added = add(*at, path, backup); !added) return added;
  }
  return problem ? Status(fail(Errc::io_error, dir + ": " + problem.message())) : Status(Done{});
}

std::string boot_text(std::uint64_t boot) {
  const std::string digits = std::to_string(boot);
  return std::string(20 - digits.size(), '0') + digits + "\n";
}

Status write_state(const NodeBackup& backup, std::uint64_t boot, const std::string& dir) {
  if (Status made = make_private_dir(dir + "/state"); !made) return made;
  if (Status done = write_file(dir + "/state/boot", boot_text(boot)); !done) return done;
  // With this file and no journal beside it, the scheduler takes its journal as lost.
  if (Status done = write_file(dir + "/state/journal.db.known", "This node comes from a backup.\n"); !done) return done;
  if (!has_robot(backup)) return Done{};
  return write_file(dir + "/state/fence", "fenced\n");  // whoever has stopped it since must not find it moving
}

Status write_all(const NodeBackup& backup, std::uint64_t boot, const std::string& dir) {
  if (Status made = make_private_dir(dir); !made) return made;
  for (const BackupFile& file : backup.files) {
    const fs::path path = fs::path(dir) / file.path;
    if (Status made = make_dir(path.parent_path().string(), 0700); !made) return made;
    if (Status done = write_file(path.string(), file.bytes, restored_mode(file)); !done) return done;
  }
  if (Status done = write_state(backup, boot, dir); !done) return done;
  return forget_sessions(dir, backup.made_s);
}

}  // namespace

Result<NodeBackup> read_node_folder(const std::string& dir, const std::string& node) {
  if (Status closed = close_gateway(dir); !closed) return closed.error();
  NodeBackup backup;
  backup.node = node;
  backup.version = kVersion;
  backup.made_s = read_clocks().utc.ns / 1'000'000'000;
  if (Status added = add_folder(dir, backup); !added) return added.error();
  std::ranges::sort(backup.files, {}, &BackupFile::path);
  if (Status good = check_no_authority(backup); !good) return good.error();
  return backup;
}

Status write_node_folder(const NodeBackup& backup, std::uint64_t boot, const std::string& dir) {
  return make_whole_folder(dir, [&](const std::string& making) { return write_all(backup, boot, making); });
}

}  // namespace trb::cli
