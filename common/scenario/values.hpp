// Parameters of a task whose values come from earlier results.
#pragma once

#include <functional>
#include <string>

#include "common/base/result.hpp"
#include "proto/bodies/run.hpp"

namespace trb {

/// The bytes of a task's data, at most: Task::data and Execute::data.
constexpr std::size_t kMaxTaskData = 65536;

/// The task's data with its `values` added, after the file's parameters and in their order: this is sent to the robot's
/// node. The same results give the same bytes. `results` returns the FINISHED result of a task, or nullptr. Errors,
/// which name task and parameter: missing (no result, no FINISHED one, or it has no such value), malformed (data or
/// result is not JSON), bad_value (the result is not an object), duplicate (data has the parameter already), too_large
/// (over kMaxTaskData).
Result<std::string> fill_values(const Task& task,
                                const std::function<const TaskResult*(const std::string& task)>& results);

}  // namespace trb
