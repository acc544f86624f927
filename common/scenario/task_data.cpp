#include "common/scenario/task_data.hpp"

#include <optional>
#include <utility>

#include "common/scenario/values.hpp"
#include "proto/value.hpp"
#include "proto/value_words.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxValues = 32;  ///< as Task::values
constexpr std::size_t kMaxName = 64;

/// No parameter's type is an object: so this must be a reference, even with one of its keys misspelt.
bool is_reference(const Value& value) {
  return value.find("from") != nullptr || value.find("value") != nullptr;
}

std::optional<ValueFrom> read_reference(const std::string& parameter, const Value& json, const std::string& path,
                                        const FileFaults& faults) {
  ObjectReader reader(json, path, faults);
  auto task = reader.text("from", Need::required, kMaxName);
  auto name = reader.text("value", Need::optional, kMaxName);
  reader.refuse_unknown_keys();
  if (name && name->empty()) {
    faults.add(reader.path("value"), "is empty", "name a value of the result, or leave it out for the whole result");
  }
  if (parameter.size() > kMaxName) {
    faults.add(path, "is a name of " + std::to_string(parameter.size()) + " bytes",
               "keep it to " + std::to_string(kMaxName));
  }
  if (!task) return std::nullopt;
  return ValueFrom{parameter, std::move(*task), name.value_or("")};
}

}  // namespace

void read_data(ObjectReader& reader, Task& task) {
  const Value* data = reader.value("data", Need::optional);
  if (data == nullptr) return;
  if (!data->is_object()) {
    return reader.faults().add(reader.path("data"), "is " + in_words(*data),
                               R"(write the skill's parameters as { "NAME": VALUE, … })");
  }
  Value::Object given;
  for (const auto& [name, value] : data->object()) {
    if (!is_reference(value)) {
      given.emplace_back(name, value);
    } else if (auto read = read_reference(name, value, reader.path("data") + "." + name, reader.faults())) {
      task.values.push_back(std::move(*read));
    }
  }
  check_count(reader.faults(), reader.path("data"), task.values.size(), kMaxValues);
  task.data = dump_json(Value{std::move(given)});
  if (task.data.size() <= kMaxTaskData) return;
  reader.faults().add(reader.path("data"), "is " + std::to_string(task.data.size()) + " bytes long",
                      "keep it to " + std::to_string(kMaxTaskData));
}

}  // namespace trb
