// A cursor marks the end of a page; the client sends it back for the next one. It names the last entry, not a count,
// so new entries do not shift the pages. It gives no rights: each page checks who may see the list.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"

namespace trb::gateway {

struct PageCursor {
  std::string list;   ///< the route and its filter; the cursor is valid for no other
  std::string after;  ///< the last entry's key, in the order of the list
  bool operator==(const PageCursor&) const = default;
};

inline constexpr std::size_t kMaxCursor = 1024;  ///< as text
inline constexpr std::uint32_t kMaxPage = 500;

/// Opaque: digits and letters.
std::string cursor_text(const PageCursor& cursor);
/// Errors: malformed (no cursor, or damaged), bad_value (another list's), too_large.
Result<PageCursor> parse_cursor(std::string_view text, std::string_view list);

template <class Entry>
struct Page {
  std::vector<const Entry*> entries;
  std::string next;  ///< empty: this is the last page
};

/// The next `most` entries after the cursor, of a map ordered by key; an empty cursor: from the first entry. Errors:
/// those of parse_cursor; bad_value (`most`).
template <class Map>
Result<Page<typename Map::value_type>> page_of(const Map& map, std::string_view list, std::string_view cursor,
                                               std::uint32_t most) {
  if (most == 0 || most > kMaxPage) {
    return fail(Errc::bad_value, "limit: " + std::to_string(most), "use 1 to " + std::to_string(kMaxPage));
  }
  auto at = map.begin();
  if (!cursor.empty()) {
    const auto parsed = parse_cursor(cursor, list);
    if (!parsed) return parsed.error();
    at = map.upper_bound(parsed->after);
  }
  Page<typename Map::value_type> out;
  for (; at != map.end() && out.entries.size() < most; ++at) out.entries.push_back(&*at);
  if (at != map.end()) out.next = cursor_text({std::string(list), out.entries.back()->first});
  return out;
}

}  // namespace trb::gateway
