#include "services/cli/commands/job_file.hpp"

#include "common/base/files.hpp"

namespace trb::cli {

Status add_file(Value::Object& job, const Arguments& arguments, const char* option, const char* key) {
  if (!arguments.has(option)) return Done{};
  const auto text = read_file(arguments.get(option));
  if (!text) return text.error();
  auto json = parse_json(*text);
  if (!json) return fail(json.error().code, arguments.get(option) + ": " + json.error().what, json.error().hint);
  job.emplace_back(key, std::move(*json));
  return Done{};
}

}  // namespace trb::cli
