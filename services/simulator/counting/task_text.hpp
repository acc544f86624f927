// How long the texts of tasks are that a forward carries: JSON as in a scenario's file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/simulator/counting/plan.hpp"

namespace trb::counting {

/// One task of a scenario's file, compact: {"id":"t3","robot":"r1","skill":"work"}.
std::string task_json(const Plan& plan, std::size_t task);

/// The sizes of all tails of the list of tasks, without the texts: they would take memory as the square of the tasks.
class TaskText {
 public:
  explicit TaskText(const Plan& plan);
  /// Bytes of the JSON list of this task and all after it.
  [[nodiscard]] std::uint64_t size_from(std::size_t task) const { return tails_[task]; }

 private:
  std::vector<std::uint64_t> tails_;
};

}  // namespace trb::counting
