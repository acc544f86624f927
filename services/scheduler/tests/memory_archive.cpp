#include "services/scheduler/tests/memory_archive.hpp"

#include <algorithm>

#include "services/scheduler/core/view.hpp"
#include "services/scheduler/io/journal.hpp"

namespace trb::scheduler::test {

void MemoryArchive::put(JournalArchive record) {
  over_[record.view.run] = {{record.view.state, record.end}, record.until};
  records_.push_back(std::move(record));
  if (records_.size() > most) records_.erase(records_.begin());
}

void MemoryArchive::prune(std::int64_t steady) {
  std::erase_if(over_, [&](const auto& one) {
    const bool has_record = std::ranges::any_of(records_, [&](const auto& is) { return is.view.run == one.first; });
    return one.second.until <= steady && !has_record;
  });
}

std::optional<Over> MemoryArchive::over(const std::string& run) const {
  const auto found = over_.find(run);
  return found == over_.end() ? std::nullopt : std::optional(found->second.over);
}

std::optional<RunView> MemoryArchive::view(const std::string& run) const {
  const auto found = std::ranges::find_if(records_, [&](const auto& record) { return record.view.run == run; });
  return found == records_.end() ? std::nullopt : std::optional(found->view);
}

std::vector<std::string> MemoryArchive::ids(const std::string& beginning, std::size_t limit) const {
  std::vector<std::string> out;
  for (auto at = records_.rbegin(); at != records_.rend() && out.size() < limit; ++at) {
    if (at->view.run.starts_with(beginning)) out.push_back(at->view.run);
  }
  return out;
}

ArchivePage MemoryArchive::page(const std::string& after, std::size_t limit) const {
  ArchivePage out;
  bool begun = after.empty();
  for (auto at = records_.rbegin(); at != records_.rend(); ++at) {
    if (begun && out.runs.size() == limit) {
      out.more = true;
      break;
    }
    if (begun) out.runs.push_back(summary_of(at->view));
    begun = begun || at->view.run == after;
  }
  return out;
}

void journal_as_file(std::vector<Body>& journal, MemoryArchive& archive, Body record) {
  if (const auto* over = get_if<JournalArchive>(&record)) {
    std::erase_if(journal, [&](const Body& one) { return *run_of(one) == over->view.run; });
    return archive.put(*over);
  }
  if (const auto* time = get_if<JournalTime>(&record)) {
    std::erase_if(journal, [](const Body& one) { return holds_alternative<JournalTime>(one); });
    archive.prune(time->steady);
  }
  journal.push_back(std::move(record));
}

}  // namespace trb::scheduler::test
