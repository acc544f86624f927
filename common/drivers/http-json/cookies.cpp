#include "common/drivers/http-json/cookies.hpp"

#include <algorithm>
#include <string_view>

namespace trb::drivers {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t from = std::min(text.find_first_not_of(" \t"), text.size());
  return text.substr(from, text.find_last_not_of(" \t") + 1 - from);
}

/// No character that could end a header or a cookie.
bool is_plain(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return c > ' ' && c < '\x7f' && c != ';' && c != ','; });
}

bool is_over(std::string_view attributes) {
  constexpr std::string_view kAge = "max-age=";
  std::string small(attributes);
  for (char& c : small) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c;
  const std::size_t at = small.find(kAge);
  if (at == std::string::npos) return false;
  const std::string_view age = trimmed(std::string_view(small).substr(at + kAge.size()));
  return age.starts_with('-') || age.substr(0, age.find(';')).find_first_not_of('0') == std::string_view::npos;
}

}  // namespace

void CookieJar::take(const std::vector<std::string>& values) {
  for (const std::string& value : values) take_one(value);
}

void CookieJar::take_one(const std::string& value) {
  const std::string_view text = value;
  const std::string_view pair = text.substr(0, text.find(';'));
  const std::size_t equals = pair.find('=');
  if (equals == std::string_view::npos || pair.size() > kMaxSize) return;
  const std::string_view name = trimmed(pair.substr(0, equals));
  const std::string_view what = trimmed(pair.substr(equals + 1));
  if (name.empty() || !is_plain(name) || !is_plain(what)) return;
  const auto at = std::ranges::find(cookies_, name, [](const auto& one) { return std::string_view(one.first); });
  const bool over = what.empty() || is_over(text.substr(pair.size()));
  if (at != cookies_.end() && over) {
    cookies_.erase(at);
  } else if (at != cookies_.end()) {
    at->second = what;
  } else if (!over && cookies_.size() < kMost) {
    cookies_.emplace_back(name, what);
  }
}

std::string CookieJar::header() const {
  std::string out;
  for (const auto& [name, value] : cookies_) out.append(out.empty() ? "" : "; ").append(name).append("=").append(value);
  return out;
}

}  // namespace trb::drivers
