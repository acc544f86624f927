#include "common/drivers/text/vendor_template.hpp"

#include <algorithm>
#include <charconv>

#include "common/drivers/text/number_text.hpp"

namespace trb::drivers {
namespace {

constexpr int kMaxItem = 99;

/// The number of a placeholder's item, -1 for "data", -2 for anything else (which then is plain text).
int hole_of(std::string_view inside) {
  if (inside == "data") return -1;
  int item = 0;
  const auto [end, error] = std::from_chars(inside.data(), inside.data() + inside.size(), item);
  const bool whole = !inside.empty() && error == std::errc() && end == inside.data() + inside.size();
  return whole && item >= 0 && item <= kMaxItem ? item : -2;
}

Error item_missing(int item, std::size_t count) {
  return fail(Errc::bad_value,
              "the command needs item " + std::to_string(item) + " of a list, and the data has " +
                  std::to_string(count) + " items",
              "give a JSON list with at least " + std::to_string(item + 1) + " items");
}

/// Every item of a list as plain text; a list is JSON, or words with spaces between them.
std::vector<std::string> plain_items(BytesView data) {
  std::vector<std::string> items;
  if (const auto json = parse_json(data); json && json->is_list()) {
    for (const Value& item : json->list()) {
      const bool real = item.is_number() && !item.is_integer();
      items.push_back(item.is_text() ? item.text() : real ? number_text(item.number()) : dump_json(item));
    }
    return items;
  }
  while (!data.empty()) {
    const std::size_t end = std::min(data.find(' '), data.size());
    if (end > 0) items.emplace_back(data.substr(0, end));
    data.remove_prefix(std::min(end + 1, data.size()));
  }
  return items;
}

bool breaks_line(char c) {
  return c == '\r' || c == '\n' || c == '\0';
}

}  // namespace

Result<std::string> json_literal(const Value& value) {
  return dump_json(value);
}

VendorTemplate::VendorTemplate(std::string_view text) {
  Part part;
  while (!text.empty()) {
    const std::size_t close = text.front() == '{' ? text.find('}') : std::string_view::npos;
    const int hole = close == std::string_view::npos ? kNone : hole_of(text.substr(1, close - 1));
    if (hole == kNone) {
      part.literal += text.front();
      text.remove_prefix(1);
      continue;
    }
    part.hole = hole;
    has_holes_ = true;
    has_items_ = has_items_ || hole >= 0;
    parts_.push_back(std::move(part));
    part = {};
    text.remove_prefix(close + 1);
  }
  parts_.push_back(std::move(part));
}

std::size_t VendorTemplate::items() const {
  std::size_t items = 0;
  for (const Part& part : parts_) {
    if (part.hole >= 0) items = std::max(items, static_cast<std::size_t>(part.hole) + 1);
  }
  return items;
}

Result<std::string> VendorTemplate::fill_plain(BytesView data, bool any_byte) const {
  if (!has_holes_) return parts_.front().literal;
  const auto items = has_items_ ? plain_items(data) : std::vector<std::string>{};
  std::string out;
  for (const Part& part : parts_) {
    out += part.literal;
    if (part.hole == kNone) continue;
    if (part.hole >= static_cast<int>(items.size())) return item_missing(part.hole, items.size());
    const BytesView filling = part.hole == kWhole ? data : BytesView(items[static_cast<std::size_t>(part.hole)]);
    if (!any_byte && std::any_of(filling.begin(), filling.end(), breaks_line)) {
      return fail(Errc::not_escapable, "the data holds a line end or a zero byte, which would end the robot's command",
                  "send one line of text");
    }
    out += filling;
  }
  return out;
}

Result<std::string> VendorTemplate::fill(BytesView data, Literal literal) const {
  if (!has_holes_) return parts_.front().literal;
  const auto json = parse_json(data);
  if (!json) {
    return fail(Errc::bad_value, "the data is no JSON: " + json.error().what,
                "give a number, true or false, a \"text\", or a list of numbers such as [0.1, -1.57]");
  }
  const std::size_t count = json->is_list() ? json->list().size() : 0;
  std::string out;
  for (const Part& part : parts_) {
    out += part.literal;
    if (part.hole == kNone) continue;
    if (part.hole >= static_cast<int>(count)) return item_missing(part.hole, count);
    auto text = literal(part.hole == kWhole ? *json : json->list()[static_cast<std::size_t>(part.hole)]);
    if (!text) return text.error();
    out += *text;
  }
  return out;
}

}  // namespace trb::drivers
