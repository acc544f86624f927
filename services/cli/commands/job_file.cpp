#include "services/cli/commands/job_file.hpp"

#include <sstream>

#include "common/base/files.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/simulation/link_kind.hpp"

namespace trb::cli {

Status add_file(Value::Object& job, const Arguments& arguments, const char* option, const char* key) {
  if (!arguments.has(option)) return Done{};
  const auto text = read_file(arguments.get(option));
  if (!text) {
    const std::string what = std::string(option) + ": " + text.error().what;
    return fail(text.error().code, what, "name a file that is there; trb simulate --help says what it has");
  }
  auto json = parse_json(*text);
  if (!json) return fail(json.error().code, arguments.get(option) + ": " + json.error().what, json.error().hint);
  job.emplace_back(key, std::move(*json));
  return Done{};
}

Status add_link(Value::Object& job, const Arguments& arguments) {
  constexpr const char* kOption = "--link";
  constexpr const char* kKey = "link";
  const std::string given = arguments.get(kOption);
  if (file_exists(given)) return add_file(job, arguments, kOption, kKey);
  if (!arguments.has(kOption)) return Done{};
  if (!simulation::find_link_kind(given)) {
    return fail(Errc::bad_value,
                "--link: " + in_quotes(given) + " is no kind of link, and no file of that name is there",
                "use lan, wifi or vpn, or name a file with delay_s, loss and bytes_a_second");
  }
  job.emplace_back(kKey, Value{given});
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
