#include "common/config/json_file.hpp"

#include "common/base/files.hpp"

namespace trb {

std::optional<Value> load_json(const std::string& path, const std::string& hint, const FileFaults& faults) {
  if (hint.empty()) {
    const Status there = look_for(path);
    if (!there && there.error().code == Errc::missing) return std::nullopt;
  }
  const auto bytes = read_file(path);
  if (!bytes) {
    const bool missing = bytes.error().code == Errc::missing;
    const std::string cure =
        bytes.error().hint.empty() ? "it must be a readable file of at most 1 MiB" : bytes.error().hint;
    faults.add("", missing ? "there is no such file: " + path : bytes.error().what, missing ? hint : cure);
    return std::nullopt;
  }
  auto json = parse_json(*bytes);
  if (json) return std::move(*json);
  const std::string& known_cure = json.error().hint;
  faults.add("", json.error().what, known_cure.empty() ? "make the file simpler" : known_cure);
  return std::nullopt;
}

}  // namespace trb
