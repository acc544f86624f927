#include "common/fleet/line_pattern.hpp"

#include <algorithm>
#include <charconv>

namespace trb {
namespace {

constexpr std::size_t kMaxPattern = 128;
constexpr std::size_t kMaxRepeats = 64;

/// {2,8} repeats its part eight times: the product of all such counts.
std::size_t repeats(std::string_view text) {
  std::size_t product = 1;
  bool inside = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '{') inside = true;
    if (text[i] == '}') inside = false;
    if (!inside || (text[i] != '{' && text[i] != ',')) continue;
    std::size_t count = 0;
    const auto end = std::from_chars(text.data() + i + 1, text.data() + text.size(), count);
    if (end.ec == std::errc::result_out_of_range) return kMaxRepeats + 1;
    if (end.ec == std::errc()) product = std::min(product * std::max<std::size_t>(count, 1), kMaxRepeats + 1);
  }
  return product;
}

}  // namespace

Result<LinePattern> LinePattern::make(const std::string& text) {
  if (text.empty() || text.size() > kMaxPattern) {
    return fail(Errc::bad_value, "is " + std::to_string(text.size()) + " bytes long",
                "write a regular expression of 1 to " + std::to_string(kMaxPattern) + " bytes");
  }
  if (repeats(text) > kMaxRepeats) {
    return fail(Errc::bad_value, "repeats its parts too often",
                "keep the numbers in {} to " + std::to_string(kMaxRepeats) + " when multiplied, or use + or *");
  }
  try {
    // Breadth first: no line makes it slow, and its depth is limited by the pattern.
    std::regex regex(text, std::regex::ECMAScript | std::regex_constants::__polynomial);
    if (regex.mark_count() > 1) return fail(Errc::bad_value, "has more than one group", "write (?:…) for the others");
    return LinePattern(std::move(regex));
  } catch (const std::regex_error&) {
    return fail(Errc::bad_value, "is no regular expression that can be used",
                R"(write one as T=(-?[0-9.]+), without back references)");
  }
}

std::optional<std::string_view> LinePattern::find(std::string_view line) const {
  std::match_results<std::string_view::const_iterator> found;
  if (!std::regex_search(line.begin(), line.end(), found, regex_)) return std::nullopt;
  const auto& group = found[found.size() - 1];
  if (!group.matched) return std::nullopt;
  return line.substr(static_cast<std::size_t>(group.first - line.begin()), static_cast<std::size_t>(group.length()));
}

}  // namespace trb
