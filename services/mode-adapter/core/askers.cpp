#include "services/mode-adapter/core/askers.hpp"

#include <algorithm>

namespace trb::adapter {
namespace {

Inbound without_data(const Inbound& message) {
  return {message.type,     message.source, message.target,       message.id,
          message.reply_to, message.flags,  message.remaining_ms, Opaque{std::string(subtype_of(message.body)), {}}};
}

}  // namespace

void Askers::add(Token token, const Inbound& message, Driver& mode, Now now) {
  const auto wait = std::chrono::milliseconds(std::min(message.remaining_ms, kLongestMs));
  const auto [at, is_new] = waiting_.emplace(token, Asker{without_data(message), &mode, now.mono + wait});
  if (is_new) deadlines_.emplace(at->second.deadline, token);
}

Asker Askers::erase(std::map<Token, Asker>::iterator at) {
  deadlines_.erase({at->second.deadline, at->first});
  Asker asker = std::move(at->second);
  waiting_.erase(at);
  return asker;
}

std::optional<Inbound> Askers::take(Token token) {
  const auto found = waiting_.find(token);
  if (found == waiting_.end()) return std::nullopt;
  return erase(found).message;
}

std::optional<Inbound> Askers::take_answered(std::string_view subtype, std::string_view source) {
  for (const auto& [token, asker] : waiting_) {
    if (asker.message.source == source && subtype_of(asker.message.body) == subtype) return take(token);
  }
  return std::nullopt;
}

std::optional<std::pair<Token, Asker>> Askers::take_expired(Now now) {
  if (deadlines_.empty() || now.mono < deadlines_.begin()->first) return std::nullopt;
  const Token token = deadlines_.begin()->second;
  return std::pair(token, erase(waiting_.find(token)));
}

std::optional<Inbound> Askers::take_any_of(const Driver* mode) {
  for (const auto& [token, asker] : waiting_) {
    if (asker.mode == mode) return take(token);
  }
  return std::nullopt;
}

std::optional<MonotonicTime> Askers::next_deadline() const {
  if (deadlines_.empty()) return std::nullopt;
  return deadlines_.begin()->first;
}

}  // namespace trb::adapter
