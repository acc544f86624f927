// An alert's text over time: its cause may be past while the failed task still waits, and a verdict may be tried in
// vain.
#pragma once

#include <string>
#include <string_view>

#include "proto/value.hpp"

namespace trb::resilience {

inline constexpr std::string_view kPastCause = "no longer so: ";
inline constexpr std::string_view kInVain = "; tried in vain: ";
constexpr std::size_t kMaxAlertText = 1024;

/// With why the last verdict was not carried out, in the place of what was said of one before.
inline std::string text_tried(const std::string& text, const std::string& why) {
  return cut_utf8(text.substr(0, text.find(kInVain)) + std::string(kInVain) + why, kMaxAlertText);
}

/// The same cause in words of now, with what was tried in vain.
inline std::string text_reworded(const std::string& text, const std::string& cause) {
  const std::size_t tried = text.find(kInVain);
  return cut_utf8(cause + (tried == std::string::npos ? "" : text.substr(tried)), kMaxAlertText);
}

[[nodiscard]] inline bool is_past(std::string_view text) {
  return text.starts_with(kPastCause);
}

/// Says of a present cause that it is past; what was tried meanwhile goes.
inline std::string text_past(const std::string& text) {
  if (is_past(text)) return text;
  return cut_utf8(std::string(kPastCause) + text.substr(0, text.find(kInVain)), kMaxAlertText);
}

}  // namespace trb::resilience
