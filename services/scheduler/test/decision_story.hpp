// A robot fails in the middle of a run, and somebody decides: what trb-resilience does, in a few lines, on the cloud's
// node.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "services/scheduler/test/fleet.hpp"

namespace trb::scheduler::test {

extern const std::string kStoryRun;

/// Section 6.1 as it was meant: tasks 4 ("approach") and 7 ("go_back") are the ridgeback's too.
Scenario ridgeback_does_it();
/// The start of a run of the fleet's nodes but for some.
SignedRecord start_without(Fleet& fleet, const Scenario& scenario, const std::set<std::string>& left_out);

class Decider {
 public:
  /// `replace`: who takes over what is not done and cannot be done by `failed`, named by `tasks`.
  Decider(Fleet& fleet, std::string failed, std::vector<std::string> tasks, std::string replacement)
      : fleet_(fleet), failed_(std::move(failed)), tasks_(std::move(tasks)), replacement_(std::move(replacement)) {}

  /// The next word, if one is due: asks tasks back, decides. Call it again and again; it keeps nothing but its verdict,
  /// and finds out by the run how far it has come.
  void step();
  /// The next epoch of these rulings, signed; on the run as the cloud's node shows it.
  [[nodiscard]] SignedRecord decision(std::vector<TaskRuling> rulings, std::vector<std::string> members = {},
                                      const std::function<void(Decision&)>& change = {}) const;

  int decided = 0;    ///< how often the decision was handed over
  bool word = false;  ///< a person has said that the failed robot stands: nothing is asked back

 private:
  Fleet& fleet_;
  std::string failed_;
  std::vector<std::string> tasks_;
  std::string replacement_;
  MonotonicTime next_{};
  MonotonicTime next_decision_{};
  std::optional<SignedRecord> signed_;
};

}  // namespace trb::scheduler::test
