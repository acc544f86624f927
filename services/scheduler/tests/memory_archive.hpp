// The archive of a node in memory, and its journal as the file keeps it.
#pragma once

#include <map>
#include <vector>

#include "proto/body.hpp"
#include "services/scheduler/core/archive.hpp"

namespace trb::scheduler::test {

class MemoryArchive final : public Archive {
 public:
  void put(JournalArchive record);
  [[nodiscard]] const std::vector<JournalArchive>& records() const { return records_; }
  /// What is over and has no record any more takes a place until its time has come.
  void prune(std::int64_t steady);
  /// How many records are kept; the oldest go.
  std::size_t most = 100'000;

  [[nodiscard]] std::optional<Over> over(const std::string& run) const override;
  [[nodiscard]] std::optional<RunView> view(const std::string& run) const override;
  [[nodiscard]] std::vector<std::string> ids(const std::string& beginning, std::size_t limit) const override;
  [[nodiscard]] ArchivePage page(const std::string& after, std::size_t limit) const override;
  [[nodiscard]] std::size_t known() const { return over_.size(); }

 private:
  struct Known {
    Over over;
    std::int64_t until = 0;
  };
  std::vector<JournalArchive> records_;  ///< in the order in which they came
  std::map<std::string, Known> over_;
};

/// Takes a committed record in: as JournalFile does, a run that is over leaves its records.
void journal_as_file(std::vector<Body>& journal, MemoryArchive& archive, Body record);

}  // namespace trb::scheduler::test
