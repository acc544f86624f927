#include "common/base/ids.hpp"
#include "common/config/readers.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxFrameworks = 64;

}  // namespace

Profile read_profile(const Value& json, const FileFaults& faults) {
  Profile profile;
  ObjectReader reader(json, "", faults);
  if (!json.is_object() || !check_count(faults, "", json.object().size(), kMaxFrameworks)) return profile;
  for (const auto& [framework, ignored] : json.object()) {
    if (!is_valid_word(framework)) {
      faults.add(framework, in_quotes(framework) + " is no name of a framework",
                 "use a letter, then letters and digits");
    }
    constexpr std::size_t kBeforeInterpreter = 1;  // a file may not choose "none"
    const auto mode = reader.choice(framework, Need::required, {"interpreter", "direct", "ros"});
    profile[framework] = mode ? static_cast<Mode>(*mode + kBeforeInterpreter) : Mode::none;
  }
  return profile;
}

}  // namespace trb
