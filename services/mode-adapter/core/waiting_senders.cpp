#include "services/mode-adapter/core/waiting_senders.hpp"

#include <algorithm>

#include "common/base/gives_way.hpp"

namespace trb::adapter {
namespace {

Inbound without_data(const Inbound& message) {
  return {message.type,     message.source, message.target,       message.id,
          message.reply_to, message.flags,  message.remaining_ms, Opaque{std::string(subtype_of(message.body)), {}}};
}

}  // namespace

void WaitingSenders::add(Token token, const Inbound& message, Driver& mode, Now now) {
  const auto wait = std::chrono::milliseconds(std::min(message.remaining_ms, kLongestMs));
  const auto [at, is_new] = waiting_.emplace(token, WaitingSender{without_data(message), &mode, now.mono + wait});
  if (is_new) deadlines_.emplace(at->second.deadline, token);
}

WaitingSender WaitingSenders::erase(std::map<Token, WaitingSender>::iterator at) {
  deadlines_.erase({at->second.deadline, at->first});
  WaitingSender sender = std::move(at->second);
  waiting_.erase(at);
  return sender;
}

std::optional<Inbound> WaitingSenders::take(Token token) {
  const auto found = waiting_.find(token);
  if (found == waiting_.end()) return std::nullopt;
  return erase(found).message;
}

std::optional<Inbound> WaitingSenders::take_answered(std::string_view subtype, std::string_view source) {
  for (const auto& [token, sender] : waiting_) {
    if (sender.message.source == source && subtype_of(sender.message.body) == subtype) return take(token);
  }
  return std::nullopt;
}

std::optional<std::pair<Token, WaitingSender>> WaitingSenders::take_expired(Now now) {
  if (deadlines_.empty() || now.mono < deadlines_.begin()->first) return std::nullopt;
  const Token token = deadlines_.begin()->second;
  return std::pair(token, erase(waiting_.find(token)));
}

std::optional<Inbound> WaitingSenders::take_any_of(const Driver* mode) {
  for (const auto& [token, sender] : waiting_) {
    if (sender.mode == mode) return take(token);
  }
  return std::nullopt;
}

std::optional<std::pair<Token, WaitingSender>> WaitingSenders::take_for(const std::string& source) {
  const std::string other =
      gives_way(waiting_, source, [](const auto& waiting) { return waiting.second.message.source; });
  if (other == source) return std::nullopt;
  const auto newest = std::find_if(waiting_.rbegin(), waiting_.rend(),
                                   [&](const auto& waiting) { return waiting.second.message.source == other; });
  const Token token = newest->first;
  return std::pair(token, erase(waiting_.find(token)));
}

std::optional<MonotonicTime> WaitingSenders::next_deadline() const {
  if (deadlines_.empty()) return std::nullopt;
  return deadlines_.begin()->first;
}

}  // namespace trb::adapter
