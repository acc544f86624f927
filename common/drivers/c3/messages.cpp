#include "common/drivers/c3/messages.hpp"

#include "common/base/ids.hpp"
#include "common/drivers/c3/krl.hpp"
#include "proto/body.hpp"

namespace trb::drivers {
namespace {

constexpr std::size_t kMaxMessage = 16U << 20U;
constexpr auto kMostSize = static_cast<std::int64_t>(kMaxMessage);

std::optional<MessageType> type_of(const std::string& word) {
  for (const MessageType type : {MessageType::command, MessageType::request, MessageType::information}) {
    if (word == name_of(type)) return type;
  }
  return std::nullopt;
}

}  // namespace

void C3Messages::restart() {
  flag_.restart();
  data_.clear();
}

void C3Messages::on_cleared(const DriverOut& out) {
  const std::vector<std::string> parts = flag_.on_cleared();
  data_ += krl_text(parts[4]);
  const std::int64_t size = krl_whole(parts[3]);
  if (data_.size() > kMaxMessage || size > kMostSize) {
    data_.clear();
    return out.refuse("message_too_long", "the robot said more than 16 MB, or that it would");
  }
  if (static_cast<std::int64_t>(data_.size()) < size) return;
  Bytes data = std::exchange(data_, {});
  const bool whole = size < 0 || static_cast<std::int64_t>(data.size()) == size;
  send(parts, whole, std::move(data), out);
}

void C3Messages::send(const std::vector<std::string>& parts, bool whole, Bytes data, const DriverOut& out) {
  const auto type = type_of(krl_text(parts[0]));
  const std::string subtype = krl_text(parts[1]);
  const std::string target = krl_text(parts[2]);
  if (!type || !is_valid_word(subtype) || !whole || (!target.empty() && !is_valid_id(target))) {
    return out.refuse("bad_message", "the robot said " + parts[0] + " " + subtype + " to " + target +
                                         ": no message, or not of the size it told");
  }
  if (is_reserved(subtype)) {
    return out.refuse("typed_subtype", "the robot said " + subtype + ", a word of the middleware's own");
  }
  out.out.count("from_robot." + subtype);
  out.emit(Said{*type, subtype, target.empty() ? own_id_ : target, std::move(data)});
}

}  // namespace trb::drivers
