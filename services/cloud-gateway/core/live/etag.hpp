// Entity tags, and the preconditions that use them (RFC 9110, sections 8.8.3, 13.1 and 13.2).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "services/cloud-gateway/core/live/row.hpp"

namespace trb::gateway {

struct ETag {
  std::string opaque;
  bool is_weak = false;
  bool operator==(const ETag&) const = default;
};

/// `instance`: of the service that counts the versions; 0: versions are on disk and survive a restart.
ETag etag_of(std::uint64_t instance, std::uint64_t version);
/// Of a row as it is shown: it changes with the content and with `live`, which says whether that still holds.
ETag etag_of(std::uint64_t instance, const Row& row);
std::string text_of(const ETag& tag);
bool is_same_strongly(const ETag& a, const ETag& b);
bool is_same_weakly(const ETag& a, const ETag& b);

/// If-Match or If-None-Match.
struct TagCondition {
  bool any = false;  ///< "*"
  std::vector<ETag> tags;
};
/// Errors: malformed, too_large; the text names `header`.
Result<TagCondition> parse_condition(std::string_view header, std::string_view text);

enum class Precondition : std::uint8_t { proceed = 0, not_modified, failed, required };

/// The preconditions of a request; `now` is nullopt if the resource does not exist yet.
struct ConditionalRequest {
  std::optional<TagCondition> if_match;
  std::optional<TagCondition> if_none_match;
  bool is_read = true;          ///< GET or HEAD
  bool needs_if_match = false;  ///< two users may edit it: refused without If-Match (428, RFC 6585)
};
Precondition evaluate(const ConditionalRequest& request, const std::optional<ETag>& now);

}  // namespace trb::gateway
