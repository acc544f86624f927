// Parameters of a task whose values earlier results give.
#pragma once

#include <functional>
#include <string>

#include "common/base/result.hpp"
#include "proto/bodies/run.hpp"

namespace trb {

/// The bytes of a task's data, at most: Task::data and Execute::data.
constexpr std::size_t kMaxTaskData = 65536;

/// The task's data with its `values` put in, behind what the file gives and in their order: what the robot's node is
/// told. The same results give the same bytes. `results` has the FINISHED result of a task, or nullptr.
/// Errors, which name task and parameter: missing (no result, none of a task that finished, or it has no such value),
/// malformed (data or result is no JSON), bad_value (the result is no object), duplicate (data has the parameter
/// already), too_large (over kMaxTaskData).
Result<std::string> fill_values(const Task& task,
                                const std::function<const TaskResult*(const std::string& task)>& results);

}  // namespace trb
