// Every run that is not over on this node.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "services/scheduler/core/journal_records.hpp"
#include "services/scheduler/core/run/run.hpp"
#include "services/scheduler/core/step.hpp"

namespace trb::scheduler {

class RunStore {
 public:
  /// Those that are over take no place.
  static constexpr std::size_t kMaxRuns = 512;
  /// What the starts and results of all open runs may take, in the journal and in memory.
  static constexpr std::size_t kMostBytes = 512U << 20U;
  /// What a run takes of one robot's results in any case, however much that robot has in other runs.
  static constexpr std::size_t kFreeBytes = 128U << 10U;

  /// `most_bytes`: other than kMostBytes for tests only.
  RunStore(std::string self, FleetAuthority authority, std::size_t most_bytes = kMostBytes)
      : self_(std::move(self)),
        certificates_(std::make_shared<Certificates>(std::move(authority))),
        most_bytes_(most_bytes) {}

  /// Takes a journaled fact in, in order. Errors: bad_value, conflict, those of Run::open: the journal is not this
  /// node's.
  Status apply(const JournalRecord& fact);

  [[nodiscard]] Result<std::unique_ptr<Run>> open(const SignedRecord& start) const {
    return Run::open(start, certificates_, self_);
  }
  Run& add(std::unique_ptr<Run> run);
  /// How many take a place: those that are not aborted. An aborted one stays until every member has confirmed that,
  /// and one that is gone for good, or does not want to, must not hold its place.
  [[nodiscard]] std::size_t taken() const;
  [[nodiscard]] bool full() const { return taken() >= kMaxRuns; }
  /// One submitter has at most 15/16 of the places that the others leave: it cannot take them all. It begins no run
  /// while as many of its runs as that are aborted, and not confirmed.
  [[nodiscard]] bool has_place_for(const std::string& submitter) const;
  /// How many bytes more a node may have, with the starts that it submits and the results that it signs as a robot. It
  /// may have a quarter of what the others leave: it takes neither their room, nor by its results a submitter's.
  [[nodiscard]] std::size_t bytes_left(const std::string& node) const;
  /// Run::received_result; and queue_full, if the robot has more than kFreeBytes in that run and its share is used up.
  [[nodiscard]] Result<HeldResult> received_result(const Run& run, const SignedRecord& record) const;
  /// The run may be changed: the end of the step looks at it.
  [[nodiscard]] Run* find(const std::string& run) const;
  /// By RunDefinition::tag; the oldest of those that bear it.
  [[nodiscard]] const Run* find_by_tag(BytesView tag) const;
  /// Oldest first; to change one: find().
  [[nodiscard]] std::span<const Run* const> runs() const { return by_age_; }
  /// All of them may be changed: the end of the step looks at each. Oldest first.
  const std::vector<Run*>& touch_all() const;
  /// Those at which the end of a step has to look (NextVisit), oldest first.
  [[nodiscard]] std::vector<Run*> due(Clock clock) const;

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
  std::size_t most_bytes_;
};

}  // namespace trb::scheduler
