#include "common/drivers/c3/wire.hpp"

#include <algorithm>

namespace trb::drivers {
namespace {

constexpr std::size_t kHeader = 4;
constexpr std::size_t kType = 1;
constexpr std::size_t kSize = 2;
constexpr std::size_t kFooter = 3;

void put_u16(Bytes& out, std::size_t number) {
  out += static_cast<char>((number >> 8U) & 0xffU);
  out += static_cast<char>(number & 0xffU);
}

std::uint16_t get_u16(BytesView bytes) {
  const auto high = static_cast<unsigned char>(bytes[0]);
  const auto low = static_cast<unsigned char>(bytes[1]);
  return static_cast<std::uint16_t>((high << 8U) | low);
}

void put_text(Bytes& out, std::string_view text) {
  put_u16(out, text.size());
  out += text;
}

/// The part after the header. A command that the server does not know is answered without a value.
Result<C3Reply> read_body(std::uint16_t tag, BytesView body) {
  C3Reply reply;
  reply.tag = tag;
  const Error broken = fail(Errc::malformed, "a C3 reply whose lengths contradict each other");
  if (body.size() < kType + kFooter) return broken;
  if (body.size() != kType + kFooter) {
    if (body.size() < kType + kSize + kFooter) return broken;
    const std::size_t size = get_u16(body.substr(kType));
    if (body.size() != kType + kSize + size + kFooter) return broken;
    reply.value = body.substr(kType + kSize, size);
  }
  const BytesView footer = body.substr(body.size() - kFooter);
  reply.error = get_u16(footer);
  reply.ok = footer[2] != 0;
  return reply;
}

}  // namespace

Bytes c3_request(std::uint16_t tag, std::string_view variable, const std::optional<std::string>& value) {
  Bytes body(1, value ? '\1' : '\0');
  put_text(body, variable);
  if (value) put_text(body, *value);
  Bytes out;
  put_u16(out, tag);
  put_u16(out, body.size());
  return out + body;
}

Status C3Reader::add(BytesView bytes, std::vector<C3Reply>& replies) {
  buffer_ += bytes;
  BytesView rest = buffer_;
  while (rest.size() >= kHeader) {
    const std::size_t length = get_u16(rest.substr(2));
    if (rest.size() < kHeader + length) break;
    auto reply = read_body(get_u16(rest), rest.substr(kHeader, length));
    if (!reply) {
      buffer_.clear();
      return reply.error();
    }
    replies.push_back(std::move(*reply));
    rest.remove_prefix(kHeader + length);
  }
  buffer_.erase(0, buffer_.size() - rest.size());
  return Done{};
}

}  // namespace trb::drivers
