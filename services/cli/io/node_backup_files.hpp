// A node's folder read for a backup, and made again from one.
#pragma once

#include <string>

#include "services/cli/core/node_backup.hpp"

namespace trb::cli {

/// The node must not run. Errors: missing, io_error, bad_value (a link, a device: a backup has plain files alone),
/// too_large; each names the path.
Result<NodeBackup> read_node_folder(const std::string& dir, const std::string& node);

/// Makes the folder, complete or not at all. What must not be there twice stays away, and says so: the scheduler finds
/// its journal lost, a robot is fenced, the gateway has no sessions and tokens, and puts on record that it comes from a
/// backup. Errors: conflict (the folder is there, with files in it), io_error, those of SqliteFile.
Status write_node_folder(const NodeBackup& backup, std::uint64_t boot, const std::string& dir);

}  // namespace trb::cli
