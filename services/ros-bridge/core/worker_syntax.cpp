#include "services/ros-bridge/core/worker_syntax.hpp"

#include <array>

#include "services/ros-bridge/core/wire_bytes.hpp"

namespace trb::ros {
namespace {

constexpr std::array<std::size_t, 14> kParts = {0, 1, 7, 1, 1, 2, 2, 1, 4, 5, 1, 5, 4, 4};
constexpr std::size_t kSize = sizeof(std::uint32_t);

/// The message's body, behind its size.
Result<WorkerMessage> read_body(BytesView body) {
  if (body.empty()) return fail(Errc::malformed, "an empty message");
  WorkerMessage message;
  message.word = static_cast<Word>(body.front());
  body.remove_prefix(1);
  const std::size_t parts = parts_of(message.word);
  if (parts == 0) return fail(Errc::malformed, "an unknown word");
  for (std::size_t i = 0; i < parts; ++i) {
    if (body.size() < kSize) return fail(Errc::malformed, "a message that ends too early");
    const auto size = get_little<std::uint32_t>(body);
    body.remove_prefix(kSize);
    if (body.size() < size) return fail(Errc::malformed, "a part that ends too late");
    message.parts.emplace_back(body.substr(0, size));
    body.remove_prefix(size);
  }
  if (!body.empty()) return fail(Errc::malformed, "a message that ends too late");
  return message;
}

}  // namespace

std::size_t parts_of(Word word) {
  const auto index = static_cast<std::size_t>(word);
  return index < kParts.size() ? kParts[index] : 0;
}

Bytes to_bytes(const WorkerMessage& message) {
  Bytes body(1, static_cast<char>(message.word));
  for (const Bytes& part : message.parts) {
    put_little(body, static_cast<std::uint32_t>(part.size()));
    body += part;
  }
  Bytes out;
  put_little(out, static_cast<std::uint32_t>(body.size()));
  return out + body;
}

Error error_of(const WorkerMessage& message) {
  const auto& parts = message.parts;
  return {errc_of(parts[1]).value_or(Errc::robot_error), parts[2], parts[3]};
}

Status WorkerReader::add(BytesView bytes, std::vector<WorkerMessage>& out) {
  rest_ += bytes;
  std::size_t at = 0;
  while (rest_.size() - at >= kSize) {
    const BytesView rest = BytesView(rest_).substr(at);
    const auto size = get_little<std::uint32_t>(rest);
    if (size > kMaxWorkerMessage) return fail(Errc::too_large, "a message of " + std::to_string(size) + " bytes");
    if (rest.size() < kSize + size) break;
    auto message = read_body(rest.substr(kSize, size));
    if (!message) return message.error();
    out.push_back(std::move(*message));
    at += kSize + size;
  }
  rest_.erase(0, at);
  return Done{};
}

}  // namespace trb::ros
