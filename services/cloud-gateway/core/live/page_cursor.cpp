#include "services/cloud-gateway/core/live/page_cursor.hpp"

#include "common/base/hex.hpp"

namespace trb::gateway {
namespace {

/// FNV-1a: it detects damaged or cut cursors. It need not be hard to forge.
std::string check_of(std::string_view list, std::string_view after) {
  std::uint64_t sum = 14695981039346656037ULL;
  const auto add = [&sum](std::string_view text) {
    for (const char c : text) sum = (sum ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  };
  add(list);
  add(std::string_view("\0", 1));
  add(after);
  std::string out;
  for (int byte = 0; byte < 8; ++byte) out += static_cast<char>((sum >> (8 * byte)) & 0xffU);
  return out;
}

constexpr std::size_t kCheck = 8;

Error damaged() {
  return fail(Errc::malformed, "cursor: this is none",
              "take it as it is from `next` of the page before, or leave it out");
}

}  // namespace

std::string cursor_text(const PageCursor& cursor) {
  return to_hex(check_of(cursor.list, cursor.after) + cursor.list + '\0' + cursor.after);
}

Result<PageCursor> parse_cursor(std::string_view text, std::string_view list) {
  if (text.size() > kMaxCursor) return fail(Errc::too_large, "cursor: " + std::to_string(text.size()) + " bytes");
  const auto bytes = from_hex(text);
  if (!bytes || bytes->size() <= kCheck) return damaged();
  const std::string_view rest = std::string_view(*bytes).substr(kCheck);
  const std::size_t end = rest.find('\0');
  if (end == std::string_view::npos) return damaged();
  PageCursor out{std::string(rest.substr(0, end)), std::string(rest.substr(end + 1))};
  if (check_of(out.list, out.after) != bytes->substr(0, kCheck)) return damaged();
  if (out.list != list) return fail(Errc::bad_value, "cursor: it is another list's", "ask for the first page anew");
  return out;
}

}  // namespace trb::gateway
