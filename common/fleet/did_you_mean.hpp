// The word that was probably meant: for faults of configuration files and of scenarios.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace trb {

/// The candidate nearest to `word`, at most two edits away; or an empty text.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

/// A hint: "did you mean 'x'?", else `otherwise` followed by the candidates (the first 40 of them).
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates, std::string_view otherwise);

/// The keys of a map, as candidates.
template <class Map>
std::vector<std::string> names_in(const Map& map) {
  std::vector<std::string> names;
  names.reserve(map.size());
  for (const auto& [name, ignored] : map) names.push_back(name);
  return names;
}

/// "a, b, c", the first 40 of them.
std::string join(const std::vector<std::string>& words);

/// The text in quotes, cut short if it is long: what a person typed, for a message.
std::string in_quotes(std::string_view text);

}  // namespace trb
