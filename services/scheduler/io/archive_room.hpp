// The bytes of an archive's records, and who must make room.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "common/sqlite/sqlite_file.hpp"

namespace trb::scheduler {

/// Counts the records of the journal's archive by submitter. Who has the most makes room, so that nobody pushes out
/// the others' records. Errors: those of SqliteFile.
class ArchiveRoom {
 public:
  /// `most`: bytes that the records may take.
  explicit ArchiveRoom(std::int64_t most) : most_(most) {}

  /// Counts anew what the file has: when it is opened, and after a transaction that was rolled back.
  Status read(SqliteFile& file);
  /// The submitter's record has these bytes.
  void add(const std::string& submitter, std::size_t bytes);
  /// Removes the oldest records of whoever has the most, until the others fit; what is known of their runs without a
  /// record stays.
  Status make(SqliteFile& file);

 private:
  std::int64_t most_;
  std::int64_t all_ = 0;
  std::map<std::string, std::int64_t> sizes_{};  ///< by submitter
};

}  // namespace trb::scheduler
