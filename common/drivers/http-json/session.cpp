#include "common/drivers/http-json/session.hpp"

#include <algorithm>

#include "common/base/words.hpp"
#include "common/drivers/http-json/keys.hpp"

namespace trb::drivers {
namespace {

constexpr std::string_view kDigest = "Digest ";

bool has(const HttpFields& fields, std::string_view name) {
  return std::ranges::any_of(fields, [&](const auto& one) { return same_header(one.first, name); });
}

}  // namespace

HttpSession::HttpSession(const DriverSettings& settings)
    : own_({{"Host", settings.host}}), keeps_cookies_(keeps_http_cookies(settings.commands)) {
  if (settings.authorization.starts_with(kDigest)) {
    digest_.emplace(std::string_view(settings.authorization).substr(kDigest.size()), settings.instance);
  } else {
    authorization_ = settings.authorization;
  }
  const HttpFields headers = http_headers(settings.commands);
  if (!has(headers, "Accept")) own_.emplace_back("Accept", "application/json");
  if (!has(headers, "Content-Type")) type_ = type_of(http_body(settings.commands));
  own_.insert(own_.end(), headers.begin(), headers.end());
}

Bytes HttpSession::encode(const HttpRequest& request) {
  HttpFields fields = own_;
  const std::string authorization = digest_ ? digest_->authorize(request.method, request.target) : authorization_;
  if (!authorization.empty()) fields.emplace_back("Authorization", authorization);
  const std::string cookies = cookies_.header();
  if (!cookies.empty()) fields.emplace_back("Cookie", cookies);
  if (!request.body.empty() && !type_.empty()) fields.emplace_back("Content-Type", type_);
  return drivers::encode(request, fields);
}

bool HttpSession::asks_for_sign_in(const HttpAnswer& answer) {
  constexpr unsigned kUnauthorized = 401;
  if (keeps_cookies_) cookies_.take(answer.cookies);
  if (answer.status != kUnauthorized) return false;
  if (digest_ && digest_->on_refused(answer.challenges)) return true;
  cookies_.clear();  // of a session that the robot may have ended
  return false;
}

std::string asked_schemes(const HttpAnswer& answer) {
  constexpr std::size_t kMost = 4;
  constexpr std::size_t kMaxScheme = 20;
  std::vector<std::string> names;
  for (const HttpChallenge& one : read_challenges(answer.challenges)) {
    std::string name = one.scheme.substr(0, kMaxScheme);
    if (name.front() >= 'a' && name.front() <= 'z') name.front() = static_cast<char>(name.front() - ('a' - 'A'));
    if (names.size() < kMost && std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
  }
  return joined(names);
}

}  // namespace trb::drivers
