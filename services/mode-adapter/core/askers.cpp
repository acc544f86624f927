#include "services/mode-adapter/core/askers.hpp"

#include <algorithm>

namespace trb::adapter {
namespace {

Inbound without_data(const Inbound& message) {
  return {message.type,     message.source, message.target,       message.id,
          message.reply_to, message.flags,  message.remaining_ms, Opaque{std::string(subtype_of(message.body)), {}}};
}

}  // namespace

void Askers::add(Token token, const Inbound& message, RobotMode& mode, Now now) {
  const auto wait = std::chrono::milliseconds(std::min(message.remaining_ms, kLongestMs));
  waiting_.emplace(token, Asker{without_data(message), &mode, now.mono + wait});
}

std::optional<Inbound> Askers::take(Token token) {
  const auto found = waiting_.find(token);
  if (found == waiting_.end()) return std::nullopt;
  Inbound message = std::move(found->second.message);
  waiting_.erase(found);
  return message;
}

std::optional<Inbound> Askers::take_answered(std::string_view subtype, std::string_view source) {
  for (const auto& [token, asker] : waiting_) {
    if (asker.message.source == source && subtype_of(asker.message.body) == subtype) return take(token);
  }
  return std::nullopt;
}

std::optional<std::pair<Token, Asker>> Askers::take_expired(Now now) {
  for (auto at = waiting_.begin(); at != waiting_.end(); ++at) {
    if (now.mono < at->second.deadline) continue;
    std::pair<Token, Asker> expired(at->first, std::move(at->second));
    waiting_.erase(at);
    return expired;
  }
  return std::nullopt;
}

std::optional<Inbound> Askers::take_any_of(const RobotMode* mode) {
  for (const auto& [token, asker] : waiting_) {
    if (asker.mode == mode) return take(token);
  }
  return std::nullopt;
}

std::optional<MonotonicTime> Askers::next_deadline() const {
  std::optional<MonotonicTime> next;
  for (const auto& [token, asker] : waiting_) next = earlier(next, asker.deadline);
  return next;
}

}  // namespace trb::adapter
