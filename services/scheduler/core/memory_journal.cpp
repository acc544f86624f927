#include "services/scheduler/core/memory_journal.hpp"

#include <algorithm>

#include "services/scheduler/core/view.hpp"

namespace trb::scheduler {

void MemoryArchive::put(JournalArchive record) {
  over_[record.view.run] = {{record.view.state, record.end}, record.until, ++count_};
  ++by_submitter_[record.view.submitter];
  records_.emplace(count_, std::move(record));
  if (records_.size() <= most_) return;
  const auto most = std::ranges::max_element(by_submitter_, {}, [](const auto& one) { return one.second; });
  const auto oldest =
      std::ranges::find_if(records_, [&](const auto& one) { return one.second.view.submitter == most->first; });
  over_[oldest->second.view.run].record = 0;
  records_.erase(oldest);
  if (--most->second == 0) by_submitter_.erase(most);
}

void MemoryArchive::prune(std::int64_t steady) {
  std::erase_if(over_, [&](const auto& one) { return one.second.until <= steady && one.second.record == 0; });
}

std::vector<JournalArchive> MemoryArchive::records() const {
  std::vector<JournalArchive> out;
  for (const auto& [number, record] : records_) out.push_back(record);
  return out;
}

std::optional<Over> MemoryArchive::over(const std::string& run) const {
  const auto found = over_.find(run);
  return found == over_.end() ? std::nullopt : std::optional(found->second.over);
}

Result<JournalArchive> MemoryArchive::record(const std::string& run) const {
  const auto found = over_.find(run);
  if (found == over_.end() || found->second.record == 0) return fail(Errc::missing, "no record of run " + run);
  return records_.at(found->second.record);
}

std::vector<std::string> MemoryArchive::ids(const std::string& beginning, std::size_t limit) const {
  std::vector<std::string> out;
  for (auto at = records_.rbegin(); at != records_.rend() && out.size() < limit; ++at) {
    if (at->second.view.run.starts_with(beginning)) out.push_back(at->second.view.run);
  }
  return out;
}

ArchivePage MemoryArchive::page(const std::string& after, std::size_t limit) const {
  ArchivePage out;
  bool begun = after.empty();
  for (auto at = records_.rbegin(); at != records_.rend(); ++at) {
    const RunView& view = at->second.view;
    if (begun && out.runs.size() == limit) {
      out.more = true;
      break;
    }
    if (begun) out.runs.push_back(summary_of(view));
    begun = begun || view.run == after;
  }
  return out;
}

MemoryJournal::MemoryJournal(std::initializer_list<JournalRecord> records) {
  for (const JournalRecord& record : records) push_back(record);
}

void MemoryJournal::push_back(JournalRecord record) {
  runs_.push_back(*run_of(record));
  records_.push_back(std::move(record));
}

template <class Match>
void MemoryJournal::drop(const Match& match) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < records_.size(); ++i) {
    if (match(i)) continue;
    if (kept != i) {
      records_[kept] = std::move(records_[i]);
      runs_[kept] = std::move(runs_[i]);
    }
    ++kept;
  }
  records_.resize(kept);
  runs_.resize(kept);
}

void MemoryJournal::commit(JournalRecord record, MemoryArchive& archive) {
  if (const auto* over = std::get_if<JournalArchive>(&record)) {
    drop([&](std::size_t i) { return runs_[i] == over->view.run; });
    return archive.put(*over);
  }
  if (const auto* time = std::get_if<JournalTime>(&record)) {
    drop([&](std::size_t i) { return std::holds_alternative<JournalTime>(records_[i]); });
    archive.prune(time->steady);
  }
  push_back(std::move(record));
}

}  // namespace trb::scheduler
