// How much room a disk has, and when it counts as full.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/base/result.hpp"

namespace trb {

/// Less than this is a full disk, in bytes: a journal's growth of some minutes. What is under way may use it up.
inline constexpr std::uint64_t kFullBytes = 8'000'000;
/// Less than this is told before the disk is full, in bytes.
inline constexpr std::uint64_t kLittleBytes = 200'000'000;
/// Where a node's own files grow, and what bounds them.
inline constexpr const char* kOwnFiles =
    "of its own there are log/ (30 MB for each service; log/proof: proof_log_mb of node.json) and state/ (runs that "
    "are "
    "over: archive_mb of node.json; a cloud's history: history of cloud.json; its audit log is never cut)";
/// The same in files.
inline constexpr std::uint64_t kFullFiles = 16;
/// A service does not start with less, in bytes: its files would be full at its first record.
inline constexpr std::uint64_t kLeastBytes = 1'000'000;

/// The disk that a folder is on.
struct DiskState {
  std::uint64_t free_bytes = 0;  ///< for a user that is not root
  std::uint64_t free_files = 0;  ///< inodes, the same way
  std::uint64_t files = 0;       ///< inodes in all; 0: the file system does not count them
  bool read_only = false;
};

/// Nothing: the folder is not there.
std::optional<DiskState> disk_state(const std::string& folder);

/// For people: that little room is left, or none; empty: there is enough.
std::string note_of_room(const DiskState& disk, const std::string& folder);

/// Whether new work may be taken whose records go to this folder. Error: queue_full, with what is short and the cure.
Status takes_more(const DiskState& disk, const std::string& folder);

}  // namespace trb
