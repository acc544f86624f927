#include "common/fleet/placeholders.hpp"

#include "common/base/ids.hpp"

namespace trb {

Template parse_template(std::string_view text) {
  Template out;
  while (!text.empty()) {
    const std::size_t open = text.find_first_of("{}");
    out.literal += text.substr(0, open);
    if (open == std::string_view::npos) break;
    const std::size_t close = text.find('}', open);
    if (text[open] == '}' || close == std::string_view::npos) {
      out.well_formed = false;
      break;
    }
    const std::string_view inside = text.substr(open + 1, close - open - 1);
    const std::size_t dot = inside.find('.');
    const std::string_view coordinate = dot == std::string_view::npos ? "" : inside.substr(dot + 1);
    if (!is_valid_word(inside.substr(0, dot))) out.well_formed = false;
    if (dot != std::string_view::npos && coordinate.empty()) out.well_formed = false;
    out.placeholders.push_back({std::string(inside.substr(0, dot)), std::string(coordinate)});
    text.remove_prefix(close + 1);
  }
  return out;
}

}  // namespace trb
