#include "services/cloud-gateway/core/live/etag.hpp"

#include <algorithm>

namespace trb::gateway {
namespace {

constexpr std::size_t kMaxHeader = 4096;
constexpr std::size_t kMaxTags = 64;

void skip_space(std::string_view& text) {
  while (!text.empty() && (text[0] == ' ' || text[0] == '\t')) text.remove_prefix(1);
}

bool is_etag_char(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte == 0x21 || (byte >= 0x23 && byte != 0x7f);
}

/// Takes one entity tag from the front; nullopt: there is none.
std::optional<ETag> take_tag(std::string_view& text) {
  ETag out;
  out.is_weak = text.starts_with("W/");
  if (out.is_weak) text.remove_prefix(2);
  if (!text.starts_with('"')) return std::nullopt;
  text.remove_prefix(1);
  const std::size_t end = text.find('"');
  if (end == std::string_view::npos) return std::nullopt;
  out.opaque = std::string(text.substr(0, end));
  if (!std::all_of(out.opaque.begin(), out.opaque.end(), is_etag_char)) return std::nullopt;
  text.remove_prefix(end + 1);
  return out;
}

/// Empty entries between commas are allowed (RFC 9110, 5.6.1).
std::optional<std::vector<ETag>> take_list(std::string_view text) {
  std::vector<ETag> out;
  bool wants_comma = false;
  for (skip_space(text); !text.empty(); skip_space(text)) {
    if (text[0] == ',') {
      text.remove_prefix(1);
      wants_comma = false;
      continue;
    }
    auto tag = wants_comma ? std::nullopt : take_tag(text);
    if (!tag) return std::nullopt;
    out.push_back(std::move(*tag));
    wants_comma = true;
  }
  if (out.empty()) return std::nullopt;
  return out;
}

bool matches(const TagCondition& condition, const std::optional<ETag>& now, bool (*same)(const ETag&, const ETag&)) {
  if (!now) return false;
  return condition.any ||
         std::any_of(condition.tags.begin(), condition.tags.end(), [&](const ETag& one) { return same(one, *now); });
}

}  // namespace

ETag etag_of(std::uint64_t instance, std::uint64_t version) {
  if (instance == 0) return {std::to_string(version)};
  return {std::to_string(instance) + "-" + std::to_string(version)};
}

ETag etag_of(std::uint64_t instance, const Row& row) {
  return {etag_of(instance, row.version).opaque + "-" + std::string(name_of(row.live))};
}

std::string text_of(const ETag& tag) {
  return (tag.is_weak ? "W/\"" : "\"") + tag.opaque + '"';
}

bool is_same_strongly(const ETag& a, const ETag& b) {
  return !a.is_weak && !b.is_weak && a.opaque == b.opaque;
}

bool is_same_weakly(const ETag& a, const ETag& b) {
  return a.opaque == b.opaque;
}

Result<TagCondition> parse_condition(std::string_view header, std::string_view text) {
  const std::string name(header);
  if (text.size() > kMaxHeader) return fail(Errc::too_large, name + ": " + std::to_string(text.size()) + " bytes");
  std::string_view word = text;
  skip_space(word);
  while (!word.empty() && (word.back() == ' ' || word.back() == '\t')) word.remove_suffix(1);
  if (word == "*") return TagCondition{true, {}};
  auto tags = take_list(word);
  if (!tags)
    return fail(Errc::malformed, name + ": no list of entity tags", "send the ETag as it was given, in its quotes");
  if (tags->size() > kMaxTags) return fail(Errc::too_large, name + ": " + std::to_string(tags->size()) + " tags");
  return TagCondition{false, std::move(*tags)};
}

/// In the order of RFC 9110, 13.2.2.
Precondition evaluate(const ConditionalRequest& request, const std::optional<ETag>& now) {
  if (request.if_match && !matches(*request.if_match, now, is_same_strongly)) return Precondition::failed;
  if (request.if_none_match && matches(*request.if_none_match, now, is_same_weakly)) {
    return request.is_read ? Precondition::not_modified : Precondition::failed;
  }
  return request.needs_if_match && !request.if_match ? Precondition::required : Precondition::proceed;
}

}  // namespace trb::gateway
