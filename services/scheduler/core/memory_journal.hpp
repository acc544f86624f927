// A node's journal and archive in memory, as the file keeps them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "services/scheduler/core/archive.hpp"

namespace trb::scheduler {

class MemoryArchive final : public Archive {
 public:
  void put(JournalArchive record);
  /// What is over and has no record any more takes a place until its time has come.
  void prune(std::int64_t steady);
  /// Every record that is kept, oldest first.
  [[nodiscard]] std::vector<JournalArchive> records() const;
  [[nodiscard]] std::size_t size() const { return records_.size(); }
  /// How many runs are known to be over.
  [[nodiscard]] std::size_t known() const { return over_.size(); }
  /// What has_room() answers from now on.
  void set_room(Status room) { room_ = std::move(room); }
  /// How many records are kept: the oldest of the submitter that has the most go.
  void keep_most(std::size_t most) { most_ = most; }

  [[nodiscard]] Status has_room(const std::string&) const override { return room_; }
  [[nodiscard]] std::optional<Over> over(const std::string& run) const override;
  [[nodiscard]] Result<JournalArchive> record(const std::string& run) const override;
  [[nodiscard]] std::vector<std::string> ids(const std::string& beginning, std::size_t limit) const override;
  [[nodiscard]] ArchivePage page(const std::string& after, std::size_t limit) const override;

 private:
  struct Known {
    Over over;
    std::int64_t until = 0;
    std::uint64_t record = 0;  ///< 0: it has made room
  };
  std::map<std::uint64_t, JournalArchive> records_;  ///< in the order in which they came
  std::map<std::string, Known> over_;
  std::map<std::string, std::size_t> by_submitter_;  ///< how many records
  std::size_t most_ = 100'000;
  Status room_ = Done{};
  std::uint64_t count_ = 0;
};

/// The journal's records, and which run each is of.
class MemoryJournal {
 public:
  MemoryJournal() = default;
  MemoryJournal(std::initializer_list<JournalRecord> records);
  /// Takes a committed record in: a run that is over leaves its records, of the time the newest is kept.
  void commit(JournalRecord record, MemoryArchive& archive);
  void push_back(JournalRecord record);
  [[nodiscard]] const JournalRecord& operator[](std::size_t index) const { return records_[index]; }
  [[nodiscard]] const JournalRecord& back() const { return records_.back(); }
  [[nodiscard]] std::size_t size() const { return records_.size(); }
  [[nodiscard]] bool empty() const { return records_.empty(); }
  [[nodiscard]] auto begin() const { return records_.begin(); }
  [[nodiscard]] auto end() const { return records_.end(); }
  [[nodiscard]] const std::vector<JournalRecord>& records() const { return records_; }

 private:
  template <class Match>
  void drop(const Match& match);
  std::vector<JournalRecord> records_;
  std::vector<std::string> runs_;
};

}  // namespace trb::scheduler
