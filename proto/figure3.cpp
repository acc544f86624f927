#include "proto/figure3.hpp"

namespace trb {
namespace {

void put_number(Bytes& out, std::uint32_t value) {
  for (const unsigned shift : {24U, 16U, 8U, 0U}) out += static_cast<char>(value >> shift);
}

std::uint32_t get_number(BytesView in) {
  std::uint32_t value = 0;
  for (const char c : in.substr(0, 4)) value = value << 8U | static_cast<unsigned char>(c);
  return value;
}

Status put_word(Bytes& out, std::string_view field, const std::string& word) {
  if (word.size() > kFigure3WordSize || word.find('\0') != std::string::npos) {
    return fail(Errc::does_not_fit_figure_3, std::string(field) + ": '" + word + "' is longer than 8 bytes",
                "use a shorter name, or the fleet's own wire");
  }
  out += word;
  out.append(kFigure3WordSize - word.size(), '\0');
  return Done{};
}

Status get_word(BytesView in, std::string_view field, std::string& word) {
  const BytesView padded = in.substr(0, kFigure3WordSize);
  const std::size_t end = std::min(padded.find('\0'), padded.size());
  if (padded.find_first_not_of('\0', end) != BytesView::npos) {
    return fail(Errc::malformed, std::string(field) + ": bytes after its end");
  }
  word = padded.substr(0, end);
  return Done{};
}

}  // namespace

Result<Bytes> to_figure3(const Message& message) {
  Bytes out;
  put_number(out, static_cast<std::uint32_t>(message.type));
  if (Status s = put_word(out, "subtype", message.subtype); !s) return s.error();
  if (Status s = put_word(out, "source", message.source); !s) return s.error();
  if (Status s = put_word(out, "target", message.target); !s) return s.error();
  put_number(out, static_cast<std::uint32_t>(message.data.size()));
  return out + message.data;
}

Result<Message> from_figure3(BytesView datagram) {
  if (datagram.size() < kFigure3HeaderSize) return fail(Errc::malformed, "datagram shorter than its 32-byte header");
  if (datagram.size() - kFigure3HeaderSize > kMaxDataSize) return fail(Errc::too_large, "data over 1 MiB");
  const std::uint32_t type = get_number(datagram);
  if (type < 1 || type > 3) return fail(Errc::bad_value, "type: " + std::to_string(type));
  Message message;
  message.type = static_cast<MessageType>(type);
  if (Status s = get_word(datagram.substr(4), "subtype", message.subtype); !s) return s.error();
  if (Status s = get_word(datagram.substr(12), "source", message.source); !s) return s.error();
  if (Status s = get_word(datagram.substr(20), "target", message.target); !s) return s.error();
  if (get_number(datagram.substr(28)) != datagram.size() - kFigure3HeaderSize) {
    return fail(Errc::malformed, "size: differs from the data's length");
  }
  message.data = datagram.substr(kFigure3HeaderSize);
  return message;
}

}  // namespace trb
