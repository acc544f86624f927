#include "services/scheduler/io/archive_room.hpp"

#include <algorithm>

namespace trb::scheduler {
namespace {

struct Oldest {
  std::int64_t seq = 0;  ///< 0: there is none
  std::int64_t size = 0;
};

Result<Oldest> oldest_of(SqliteFile& file, const std::string& submitter) {
  Oldest out;
  const Status read = file.rows(
      "SELECT seq, LENGTH(record) FROM archive WHERE record IS NOT NULL AND submitter = ? ORDER BY seq LIMIT 1",
      [&](const Columns& row) -> Status {
        out = {row.integer(0), row.integer(1)};
        return Done{};
      },
      submitter);
  if (!read) return read.error();
  return out.seq == 0 ? Result<Oldest>(file.damaged("its archive is not what it was")) : out;
}

}  // namespace

Status ArchiveRoom::read(SqliteFile& file) {
  all_ = 0;
  sizes_.clear();
  return file.rows("SELECT submitter, SUM(LENGTH(record)) FROM archive WHERE record IS NOT NULL GROUP BY submitter",
                   [&](const Columns& row) -> Status {
                     const std::int64_t bytes = row.integer(1);
                     sizes_[row.text(0)] = bytes;
                     all_ += bytes;
                     return Done{};
                   });
}

void ArchiveRoom::add(const std::string& submitter, std::size_t bytes) {
  const auto size = static_cast<std::int64_t>(bytes);
  all_ += size;
  sizes_[submitter] += size;
}

Status ArchiveRoom::make(SqliteFile& file) {
  while (all_ > most_) {
    const auto most = std::ranges::max_element(sizes_, {}, [](const auto& one) { return one.second; });
    const auto oldest = oldest_of(file, most->first);
    if (!oldest) return oldest.error();
    if (auto dropped = file.run("UPDATE archive SET record = NULL, summary = NULL WHERE seq = ?", oldest->seq);
        !dropped) {
      return dropped;
    }
    all_ -= oldest->size;
    most->second -= oldest->size;
    if (most->second == 0) sizes_.erase(most);
  }
  return Done{};
}

}  // namespace trb::scheduler
