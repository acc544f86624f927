#include "services/cloud-gateway/core/live/message_log.hpp"

#include <algorithm>
#include <utility>

namespace trb::gateway {
namespace {

constexpr std::size_t kMessageSize = sizeof(PassedMessage);

PassedMessage passed(char direction, UtcTime time, HeaderView header) {
  PassedMessage out;
  out.time = time;
  out.direction = direction;
  out.phase = phase_of(header.subtype);
  out.size = header.data.size();
  if (out.size > MessageLog::kMaxData) header.data = {};
  out.message = to_message(header);
  return out;
}

bool is_asked_for(const PassedMessage& one, const MessageQuery& query) {
  const Message& message = one.message;
  return (query.node.empty() || message.source == query.node || message.target == query.node) &&
         (query.subtype.empty() || message.subtype == query.subtype) && (!query.type || message.type == *query.type) &&
         (!query.phase || one.phase == *query.phase);
}

}  // namespace

const PassedMessage& MessageLog::Room::add(PassedMessage message) {
  size += kMessageSize + message.message.data.size();
  messages.push_back(std::move(message));
  while (messages.size() > most || size > kMaxBytes) {
    size -= kMessageSize + messages.front().message.data.size();
    messages.pop_front();
  }
  return messages.back();
}

const PassedMessage& MessageLog::add(char direction, UtcTime time, const HeaderView& header) {
  PassedMessage message = passed(direction, time, header);
  message.number = ++last_;
  ++counts_[static_cast<std::size_t>(message.phase)];
  Room& room = message.phase == CostPhase::upkeep ? upkeep_ : work_;
  return room.add(std::move(message));
}

/// Who names a subtype of upkeep means it.
const MessageLog::Room& MessageLog::room_of(const MessageQuery& query) const {
  const bool named = !query.phase && !query.subtype.empty() && phase_of(query.subtype) == CostPhase::upkeep;
  return named || query.phase == CostPhase::upkeep ? upkeep_ : work_;
}

MessageLog::Found MessageLog::find(const MessageQuery& query) const {
  const auto& all = room_of(query).messages;
  const auto first =
      std::lower_bound(all.begin(), all.end(), query.before,
                       [](const PassedMessage& one, std::uint64_t before) { return one.number < before; });
  Found out;
  for (auto at = std::make_reverse_iterator(first); at != all.rend(); ++at) {
    if (!is_asked_for(*at, query)) continue;
    if (out.messages.size() == query.most) {
      out.next = out.messages.back()->number;
      break;
    }
    out.messages.push_back(&*at);
  }
  return out;
}

}  // namespace trb::gateway
