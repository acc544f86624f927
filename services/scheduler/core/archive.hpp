// The runs that are over on this node: what the journal's file keeps of them, for the core to read.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/scheduler/core/journal_records.hpp"

namespace trb::scheduler {

/// What is known of a run that is over for as long as anything may still come for it.
struct Over {
  RunState state{};
  SignedRecord end;  ///< the RunEnd; without a kind: there is none
};

/// A page of summaries, newest first.
struct ArchivePage {
  std::vector<RunSummary> runs;
  bool more = false;
};

/// Filled by JournalArchive records as they are committed.
class Archive {
 public:
  Archive() = default;
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;
  virtual ~Archive() = default;

  /// Whether a new run of that submitter may be taken: its records need room, and what stays known of it once it is
  /// over. Error: queue_full, with what is short and the cure.
  [[nodiscard]] virtual Status has_room(const std::string& submitter) const = 0;
  /// Nothing: the run is not over here.
  [[nodiscard]] virtual std::optional<Over> over(const std::string& run) const = 0;
  /// Errors: missing (it is not here, or its record has made room for younger ones), io_error (it cannot be read, or is
  /// damaged: the text names the file).
  [[nodiscard]] virtual Result<JournalArchive> record(const std::string& run) const = 0;
  /// Ids that begin so, newest first, `most` of them.
  [[nodiscard]] virtual std::vector<std::string> ids(const std::string& beginning, std::size_t most) const = 0;
  /// The runs that were put in before `after`; all if that is empty.
  [[nodiscard]] virtual ArchivePage page(const std::string& after, std::size_t most) const = 0;
};

}  // namespace trb::scheduler
