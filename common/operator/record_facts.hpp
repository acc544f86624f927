// What a run's signed records say that its view does not: who ended it, and who did a task that two robots have done.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "proto/bodies/run.hpp"
#include "proto/bodies/run_view.hpp"

namespace trb::op {

/// Who ended a run before its end.
struct RunEnder {
  std::string node;    ///< at which it was ordered
  std::string reason;  ///< with the person's name, if it was ordered on the page
  UtcTime time;
};

/// The view leaves open who ended the run, or a task of it was moved or done twice.
bool needs_records(const RunView& view);

/// By the earliest order that ends it; nothing: there is none among them.
std::optional<RunEnder> ender_of(const RunRecords& records);

/// The results by which the task is done, in the order of their ends; more than one: it was done twice.
std::vector<TaskResult> doers_of(const RunRecords& records, const std::string& task);

}  // namespace trb::op
