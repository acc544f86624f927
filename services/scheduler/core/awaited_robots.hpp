// The robots of other nodes that due tasks wait for: what keeps them from it, by the own router's table, in which each
// node's row has what that node tells of itself.
#pragma once

#include <optional>
#include <string>

#include "services/scheduler/core/run_store.hpp"
#include "services/scheduler/core/step.hpp"

namespace trb::scheduler {

class AwaitedRobots {
 public:
  /// Most tasks begin within this: then nothing is requested.
  static constexpr Duration kPatience = std::chrono::seconds(1);
  static constexpr Duration kAgain = std::chrono::seconds(5);

  AwaitedRobots(std::string node, RunStore& runs) : node_(std::move(node)), runs_(runs) {}

  /// A run that the step's end looks at: it may have tasks that are due by now.
  void look(const Run& run, Step step);
  /// Requests the table, if it is time.
  void tick(Step step);
  /// Notes in the runs what keeps the robots that their tasks wait for.
  void on_routes(const RouteTable& table) const;

  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return next_; }

 private:
  [[nodiscard]] std::optional<MonotonicTime> wanted_at(const Run& run) const;
  [[nodiscard]] std::optional<MonotonicTime> wanted_at() const;

  std::string node_;
  RunStore& runs_;
  std::optional<MonotonicTime> asked_;  ///< when the table was last requested
  std::optional<MonotonicTime> next_;
};

}  // namespace trb::scheduler
