#include "common/drivers/arcos/packet.hpp"

#include <utility>

namespace trb::drivers {
namespace {

constexpr BytesView kHeader = "\xfa\xfb";
constexpr std::size_t kBeforeType = 3;  ///< header and count
constexpr std::size_t kChecksum = 2;
constexpr char kPositive = 0x3b;
constexpr char kNegative = 0x1b;
constexpr char kText = 0x2b;

std::uint8_t byte_at(BytesView bytes, std::size_t at) {
  return static_cast<std::uint8_t>(bytes[at]);
}

Bytes packet(BytesView type_and_contents) {
  const std::uint16_t sum = arcos_checksum(type_and_contents);
  Bytes out(kHeader);
  out += static_cast<char>(type_and_contents.size() + kChecksum);
  out += type_and_contents;
  out += static_cast<char>(sum >> 8U);
  out += static_cast<char>(sum & 0xffU);
  return out;
}

}  // namespace

std::uint16_t arcos_checksum(BytesView bytes) {
  std::uint32_t sum = 0;
  std::size_t at = 0;
  for (; at + 1 < bytes.size(); at += 2) sum += (byte_at(bytes, at) << 8U) + byte_at(bytes, at + 1);
  if (at < bytes.size()) sum ^= byte_at(bytes, at);
  return static_cast<std::uint16_t>(sum);
}

Bytes arcos_command(std::uint8_t number) {
  return packet(Bytes(1, static_cast<char>(number)));
}

Bytes arcos_command(std::uint8_t number, int argument) {
  const auto size = static_cast<std::uint32_t>(argument < 0 ? -argument : argument);
  Bytes bytes(1, static_cast<char>(number));
  bytes += argument < 0 ? kNegative : kPositive;
  bytes += static_cast<char>(size & 0xffU);
  bytes += static_cast<char>((size >> 8U) & 0xffU);
  return packet(bytes);
}

Bytes arcos_command(std::uint8_t number, BytesView text) {
  text = text.substr(0, kMaxArcosText);
  Bytes bytes(1, static_cast<char>(number));
  bytes += kText;
  bytes += static_cast<char>(text.size());
  bytes += text;
  return packet(bytes);
}

void ArcosReader::add(BytesView bytes, std::vector<ArcosPacket>& out) {
  buffer_ += bytes;
  while (take_one(out)) {
  }
}

bool ArcosReader::begins_with_header() {
  const std::size_t begin = buffer_.find(kHeader);
  if (begin == Bytes::npos) {
    // The last byte may be the first of a header.
    const bool half = buffer_.ends_with(kHeader.front());
    drop(buffer_.size() - (half ? 1 : 0));
    return false;
  }
  drop(begin);
  return buffer_.size() > kHeader.size();
}

bool ArcosReader::take_one(std::vector<ArcosPacket>& out) {
  if (!begins_with_header()) return false;
  const std::size_t count = byte_at(buffer_, kHeader.size());
  if (count <= kChecksum) {
    drop(kHeader.size());
    return true;
  }
  if (buffer_.size() < kBeforeType + count) return false;
  const BytesView body = BytesView(buffer_).substr(kBeforeType, count - kChecksum);
  const std::size_t end = kBeforeType + body.size();
  if (arcos_checksum(body) != (byte_at(buffer_, end) << 8U) + byte_at(buffer_, end + 1)) {
    // The header may have been garbage, with a good packet inside.
    ++losses_.wrong;
    drop(kHeader.size());
    return true;
  }
  out.push_back({byte_at(body, 0), Bytes(body.substr(1))});
  buffer_.erase(0, end + kChecksum);
  return true;
}

void ArcosReader::drop(std::size_t size) {
  losses_.garbage += size;
  buffer_.erase(0, size);
}

ArcosReader::Losses ArcosReader::take_losses() {
  return std::exchange(losses_, {});
}

}  // namespace trb::drivers
