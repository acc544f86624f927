// A person's view of runs: answers to queries, and changes for watchers.
#pragma once

#include "common/actor/takes.hpp"
#include "services/scheduler/core/archive.hpp"
#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/run_store.hpp"
#include "services/scheduler/core/step.hpp"
#include "services/scheduler/core/watchers.hpp"

namespace trb::scheduler {

class QueryHandler {
 public:
  using Taken = Takes<RunQuery, RunProofRequest, RunListRequest, RunWatch>;

  /// All must outlive it.
  QueryHandler(const RunStore& runs, const Archive& archive, const Executor& executor, Watchers& watchers)
      : runs_(runs), archive_(archive), executor_(executor), watchers_(watchers) {}

  void handle(const RunQuery& body, const Inbound& from, Step step);
  void handle(const RunProofRequest& body, const Inbound& from, Step step);
  void handle(const RunListRequest& body, const Inbound& from, Step step);
  void handle(const RunWatch& body, const Inbound& from, Step step);

  /// At a step's end: notifies the watchers of what has changed.
  void notify_watchers(Step step);

 private:
  /// Finds a run by its id, or a unique beginning of it; the newest of all if nothing is named.
  [[nodiscard]] Result<std::string> find(const std::string& name) const;
  [[nodiscard]] Result<std::string> choose(const std::string& beginning) const;
  /// Why the archive has no record of it to show: it has made room for younger ones, or `why` it cannot be read.
  [[nodiscard]] Error gone(const std::string& run, const Error& why) const;
  [[nodiscard]] Result<std::string> newest() const;
  [[nodiscard]] RunTable open_runs(Step step) const;

  const RunStore& runs_;
  const Archive& archive_;
  const Executor& executor_;
  Watchers& watchers_;
};

}  // namespace trb::scheduler
