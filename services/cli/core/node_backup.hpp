// What of a node's folder a backup has, as one file; and what of it may come back.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

namespace trb::cli {

struct BackupFile {
  std::string path;   ///< within the folder: "keys/link.key"
  unsigned mode = 0;  ///< rights, at most 0755
  Bytes bytes;
};

struct NodeBackup {
  std::string node;
  std::string version;      ///< of the trb that made it
  std::int64_t made_s = 0;  ///< UTC
  std::vector<BackupFile> files;
};

constexpr std::string_view kBackupHead = "talkrobots node backup 1\n";  ///< before the locked rest
constexpr std::size_t kBackupBytes = std::size_t{256} << 20U;           ///< all files together
constexpr std::size_t kBackupFiles = 4096;

/// Does it belong into a backup? What a node writes of its own work does not: sockets, logs, and of state/ all that
/// must not be there twice (journal.db, capability.db).
bool is_kept(std::string_view path);

/// By its node.json.
bool has_robot(const NodeBackup& backup);

/// What is to be done with the restored node, for people.
std::vector<std::string> next_steps(const NodeBackup& backup, const std::string& dir);

/// Errors: bad_value, if a copy of the authority's folder is among the files.
Status check_no_authority(const NodeBackup& backup);

/// What is locked with the passphrase. Errors: too_large, naming what.
Result<Bytes> pack(const NodeBackup& backup);
/// Errors: malformed, too_large, bad_value (a path that leads out of the folder or that no backup has, one that is
/// there twice, rights), each naming the file.
Result<NodeBackup> unpack(BytesView bytes);

/// The rights that the file gets: a key's are its owner's alone.
unsigned restored_mode(const BackupFile& file);

/// The boot number before the restored node's first start: no lower than any that the backup knows, and no lower than
/// those that the node has had since, which were seconds of UTC. Errors: conflict if this clock is before the backup's.
Result<std::uint64_t> restored_boot(const NodeBackup& backup, std::int64_t now_s);

}  // namespace trb::cli
