#include "services/cloud-gateway/core/access/sign_in_guard.hpp"

#include <algorithm>

namespace trb::gateway {
namespace {

std::string pair_of(std::string_view user, std::string_view source) {
  return std::string(user) + '\0' + std::string(source);
}

}  // namespace

bool SignInGuard::is_known(std::string_view user, std::string_view source) const {
  const auto at = known_.find(user);
  return at != known_.end() && std::ranges::find(at->second, source) != at->second.end();
}

Duration SignInGuard::wait(std::string_view user, std::string_view source, MonotonicTime now) const {
  if (is_known(user, source)) return pairs_.wait(pair_of(user, source), now);
  return std::max(users_.wait(user, now), sources_.wait(source, now));
}

Attempt SignInGuard::begin(std::string_view user, std::string_view source, MonotonicTime now) {
  Attempt attempt{std::string(user), std::string(source), is_known(user, source)};
  if (attempt.known) {
    pairs_.count(pair_of(user, source), now);
  } else {
    users_.count(user, now);
    sources_.count(source, now);
  }
  return attempt;
}

void SignInGuard::succeeded(const Attempt& attempt) {
  cancel(attempt);
  remember(attempt.user, attempt.source);
}

void SignInGuard::cancel(const Attempt& attempt) {
  if (attempt.known) return pairs_.take_back(pair_of(attempt.user, attempt.source));
  users_.take_back(attempt.user);
  sources_.take_back(attempt.source);
}

void SignInGuard::forget_user(const std::string& user) {
  known_.erase(user);
}

void SignInGuard::remember(const std::string& user, const std::string& source) {
  std::vector<std::string>& sources = known_[user];
  std::erase(sources, source);
  sources.insert(sources.begin(), source);
  if (sources.size() > kKnownOfUser) sources.resize(kKnownOfUser);
}

}  // namespace trb::gateway
