#include "common/scenario/values.hpp"

#include <utility>
#include <vector>

#include "common/fleet/did_you_mean.hpp"
#include "proto/value.hpp"
#include "proto/value_words.hpp"

namespace trb {
namespace {

/// A result stands one level deeper in the data than it did by itself.
constexpr ParseLimits kResultLimits{.bytes = kMaxTaskData, .depth = ParseLimits{}.depth - 1};

Result<Value> parse_result(const ValueFrom& from, const TaskResult* result) {
  const std::string of = in_quotes(from.task);
  const std::string hint = "look at the run: trb scenario watch";
  if (result == nullptr) return fail(Errc::missing, "there is no result of " + of, hint);
  if (result->outcome == TaskOutcome::skipped) {
    return fail(Errc::missing, of + " was skipped and has no result", "skip this task on the same condition");
  }
  if (result->outcome != TaskOutcome::finished) return fail(Errc::missing, of + " has not finished", hint);
  if (result->data.empty()) {
    return fail(Errc::missing, of + " ended without a value", "let its robot tell one when it is done");
  }
  auto json = parse_json(result->data, kResultLimits);
  if (json) return json;
  const Errc code = json.error().code == Errc::too_large ? Errc::too_large : Errc::malformed;
  return fail(code, "the result of " + of + ": " + json.error().what, "let its robot tell a smaller or plainer one");
}

Result<Value> value_of(const ValueFrom& from, const TaskResult* result) {
  auto json = parse_result(from, result);
  if (!json || from.name.empty()) return json;
  const std::string of = "the result of " + in_quotes(from.task);
  if (!json->is_object()) {
    return fail(Errc::bad_value, of + " is " + in_words(*json) + " and has no values by name",
                R"(leave "value" out to take the whole result)");
  }
  if (const Value* found = json->find(from.name)) return Value(*found);
  std::vector<std::string> names;
  for (const auto& [name, ignored] : json->object()) names.push_back(name);
  return fail(Errc::missing, of + " has no value " + in_quotes(from.name),
              did_you_mean(from.name, names, names.empty() ? "it is empty" : "use one of"));
}

Error of_parameter(const Task& task, const ValueFrom& from, const Error& error) {
  return fail(error.code, "task '" + task.id + "', parameter " + in_quotes(from.parameter) + ": " + error.what,
              error.hint);
}

}  // namespace

Result<std::string> fill_values(const Task& task,
                                const std::function<const TaskResult*(const std::string& task)>& results) {
  if (task.values.empty()) return task.data;
  auto data = parse_json(task.data.empty() ? "{}" : task.data);
  if (!data || !data->is_object()) {
    return fail(Errc::malformed, "task '" + task.id + "': its data is no JSON object", "correct the scenario");
  }
  for (const ValueFrom& from : task.values) {
    if (data->find(from.parameter) != nullptr) {
      return of_parameter(task, from, fail(Errc::duplicate, "has a value already", "give it one"));
    }
    auto value = value_of(from, results(from.task));
    if (!value) return of_parameter(task, from, value.error());
    std::get<Value::Object>(data->is).emplace_back(from.parameter, std::move(*value));
  }
  std::string text = dump_json(*data);
  if (text.size() <= kMaxTaskData) return text;
  return of_parameter(task, task.values.back(),
                      fail(Errc::too_large, "the data would be " + std::to_string(text.size()) + " bytes long",
                           "keep them to " + std::to_string(kMaxTaskData)));
}

}  // namespace trb
