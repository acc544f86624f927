// Every run that is not over on this node.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "services/scheduler/core/journal_records.hpp"
#include "services/scheduler/core/run/run.hpp"

namespace trb::scheduler {

class RunStore {
 public:
  /// Those that are over take no place.
  static constexpr std::size_t kMaxRuns = 512;

  RunStore(std::string self, FleetAuthority authority)
      : self_(std::move(self)), certificates_(std::make_shared<Certificates>(std::move(authority))) {}

  /// Takes a journaled fact in, in order. Errors: bad_value, conflict, those of Run::open: the journal is not this
  /// node's.
  Status apply(const JournalRecord& fact);

  [[nodiscard]] Result<std::unique_ptr<Run>> open(const SignedRecord& start) const {
    return Run::open(start, certificates_, self_);
  }
  Run& add(std::unique_ptr<Run> run);
  [[nodiscard]] bool full() const { return runs_.size() >= kMaxRuns; }
  /// One submitter has at most 15/16 of the places that the others leave: it cannot take them all.
  [[nodiscard]] bool has_place_for(const std::string& submitter) const;
  [[nodiscard]] Run* find(const std::string& run) const;
  /// By RunDefinition::tag; the oldest of those that bear it.
  [[nodiscard]] Run* find_by_tag(BytesView tag) const;
  /// Oldest first.
  [[nodiscard]] const std::vector<Run*>& runs() const { return by_age_; }

  /// The run is over.
  void remove(const std::string& run);

 private:
  Status apply_start(const JournalRun& fact);
  template <class Fact>
  Status apply_to(const std::string& run, const Fact& fact);

  std::string self_;
  std::shared_ptr<Certificates> certificates_;
  std::map<std::string, std::unique_ptr<Run>> runs_;
  std::vector<Run*> by_age_;
};

}  // namespace trb::scheduler
