#include "services/cli/commands/job_file.hpp"

#include <sstream>

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

Status add_name_or_file(Value::Object& job, const Arguments& arguments, const char* option, const char* key) {
  if (file_exists(arguments.get(option))) return add_file(job, arguments, option, key);
  if (arguments.has(option)) job.emplace_back(key, Value{arguments.get(option)});
  return Done{};
}

void add_list(Value::Object& job, const Arguments& arguments, const char* option, const char* key) {
  if (!arguments.has(option)) return;
  Value::List out;
  std::istringstream words(arguments.get(option));
  for (std::string one; std::getline(words, one, ',');) out.push_back(Value{one});
  job.emplace_back(key, Value{std::move(out)});
}

}  // namespace trb::cli
