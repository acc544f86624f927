#include "proto/message.hpp"

#include <cstring>
#include <msgpack/null_visitor.hpp>
#include <msgpack/pack.hpp>
#include <msgpack/parse.hpp>
#include <msgpack/unpack.hpp>

#include "common/base/ids.hpp"
#include "proto/string_buffer.hpp"
#include "proto/value.hpp"

namespace trb {
namespace {

constexpr std::uint32_t kHeaderFields = 6;

template <class T>
void put_big_endian(char* at, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) at[i] = static_cast<char>(value >> (8 * (sizeof(T) - 1 - i)));
}

template <class T>
T get_big_endian(const char* at) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) value = static_cast<T>(value << 8U) | static_cast<unsigned char>(at[i]);
  return value;
}

template <>
std::uint8_t get_big_endian<std::uint8_t>(const char* at) {
  return static_cast<std::uint8_t>(*at);
}

/// Accepts exactly one array of three texts and three numbers; anything else stops the parser.
class HeaderVisitor : public msgpack::null_visitor {
 public:
  explicit HeaderVisitor(HeaderView& out) : out_(out) {}

  bool start_array(std::uint32_t count) {
    if (depth_++ != 0 || count < kHeaderFields) return false;
    count_ = count;
    return true;
  }
  bool visit_str(const char* text, std::uint32_t size) {
    if (depth_ != 1 || size > kMaxIdSize) return false;
    const std::string_view view(text, size);
    switch (index_++) {
      case 0:
        out_.subtype = view;
        return true;
      case 1:
        out_.source = view;
        return true;
      case 2:
        out_.target = view;
        return true;
      default:
        return index_ > kHeaderFields;
    }
  }
  bool visit_positive_integer(std::uint64_t number) {
    if (depth_ != 1) return false;
    switch (index_++) {
      case 3:
        out_.id = number;
        return true;
      case 4:
        out_.reply_to = number;
        return true;
      case 5:
        size_ = number;
        return true;
      default:
        return index_ > kHeaderFields;
    }
  }
  bool visit_negative_integer(std::int64_t) { return false; }
  bool visit_nil() { return false; }
  bool visit_boolean(bool) { return false; }
  bool visit_float32(float) { return false; }
  bool visit_float64(double) { return false; }
  bool visit_bin(const char*, std::uint32_t) { return false; }
  bool visit_ext(const char*, std::uint32_t) { return false; }
  bool start_map(std::uint32_t) { return false; }
  void parse_error(std::size_t, std::size_t) {}
  void insufficient_bytes(std::size_t, std::size_t) {}

  [[nodiscard]] bool complete() const { return index_ == count_ && count_ >= kHeaderFields; }
  [[nodiscard]] std::uint64_t size() const { return size_; }

 private:
  HeaderView& out_;
  std::uint32_t depth_ = 0;
  std::uint32_t count_ = 0;
  std::uint32_t index_ = 0;
  std::uint64_t size_ = 0;
};

/// The header in its usual form, an array of six, without what msgpack's parser allocates for each message.
class PlainHeader {
 public:
  PlainHeader(BytesView frame, std::size_t offset) : frame_(frame), at_(offset) {}

  /// False if it has another form or is malformed; then use the parser.
  bool read(HeaderView& out) {
    return byte() == kArrayOfSix && text(out.subtype) && text(out.source) && text(out.target) && number(out.id) &&
           number(out.reply_to) && number(size_);
  }
  [[nodiscard]] std::size_t end() const { return at_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }

 private:
  static constexpr unsigned kArrayOfSix = 0x96;
  static constexpr unsigned kEnd = 0x100;

  unsigned byte() { return at_ < frame_.size() ? static_cast<unsigned char>(frame_[at_++]) : kEnd; }
  bool text(std::string_view& out) {
    const unsigned tag = byte();
    const unsigned size = tag == 0xd9 ? byte() : tag ^ 0xa0U;  // str 8; fixstr has up to 31
    if ((tag != 0xd9 && size > 31) || size > kMaxIdSize || frame_.size() - at_ < size) return false;
    out = frame_.substr(at_, size);
    at_ += size;
    return true;
  }
  bool number(std::uint64_t& out) {
    out = byte();
    if (out < 0x80) return true;
    if (out < 0xcc || out > 0xcf) return false;  // uint 8, 16, 32, 64
    const std::size_t width = std::size_t{1} << (out - 0xcc);
    if (frame_.size() - at_ < width) return false;
    out = 0;
    for (std::size_t i = 0; i < width; ++i) out = out << 8U | byte();
    return true;
  }

  BytesView frame_;
  std::size_t at_;
  std::uint64_t size_ = 0;
};

Status read_prefix(BytesView frame, HeaderView& view) {
  if (frame.size() > kMaxFrameSize) return fail(Errc::too_large, "frame of " + std::to_string(frame.size()) + " bytes");
  if (frame.size() < kPrefixSize) return fail(Errc::malformed, "frame shorter than its prefix");
  const auto type = get_big_endian<std::uint8_t>(frame.data() + 1);
  if (type < 1 || type > 3) return fail(Errc::bad_value, "type " + std::to_string(type));
  view.type = static_cast<MessageType>(type);
  view.flags = get_big_endian<std::uint16_t>(frame.data() + 2);
  view.remaining_ms = get_big_endian<std::uint32_t>(frame.data() + 4);
  view.link = get_big_endian<std::uint64_t>(frame.data() + 8);
  view.sequence = get_big_endian<std::uint64_t>(frame.data() + 16);
  return Done{};
}

}  // namespace

Bytes encode_frame(const Message& message) {
  Bytes frame;
  frame.reserve(kPrefixSize + 64 + message.data.size());
  frame.resize(kPrefixSize);
  put_big_endian<std::uint8_t>(frame.data(), kWireVersion);
  put_big_endian<std::uint8_t>(frame.data() + 1, static_cast<std::uint8_t>(message.type));
  put_big_endian<std::uint16_t>(frame.data() + 2, message.flags);
  stamp_link(frame.data(), 0, 0, message.remaining_ms);
  StringBuffer buffer{frame};
  msgpack::packer<StringBuffer> packer(buffer);
  const auto text = [&packer](const std::string& value) {
    packer.pack_str(static_cast<std::uint32_t>(value.size()));
    packer.pack_str_body(value.data(), static_cast<std::uint32_t>(value.size()));
  };
  packer.pack_array(kHeaderFields);
  text(message.subtype);
  text(message.source);
  text(message.target);
  packer.pack_uint64(message.id);
  packer.pack_uint64(message.reply_to);
  packer.pack_uint64(message.data.size());
  frame += message.data;
  return frame;
}

std::uint8_t wire_version(BytesView frame) {
  return frame.empty() ? 0 : get_big_endian<std::uint8_t>(frame.data());
}

Result<HeaderView> decode_frame(BytesView frame) {
  if (!frame.empty() && wire_version(frame) != kWireVersion) {
    return fail(Errc::version_mismatch, "wire version " + std::to_string(wire_version(frame)),
                "install the same version of talkrobots on both nodes");
  }
  return decode_frame_of_any_version(frame);
}

Result<HeaderView> decode_frame_of_any_version(BytesView frame) {
  HeaderView view;
  if (Status prefix = read_prefix(frame, view); !prefix) return prefix.error();
  std::size_t offset = kPrefixSize;
  std::uint64_t size = 0;
  if (PlainHeader plain(frame, kPrefixSize); plain.read(view)) {
    offset = plain.end();
    size = plain.size();
  } else {
    HeaderVisitor visitor(view);
    if (!msgpack::parse(frame.data(), frame.size(), offset, visitor) || !visitor.complete())
      return fail(Errc::malformed, "header is no array of three texts and three numbers");
    size = visitor.size();
  }
  if (!is_valid_word(view.subtype)) return fail(Errc::bad_value, "subtype is no word");
  // They go into logs and Nacks.
  if (!is_utf8(view.source) || !is_utf8(view.target)) return fail(Errc::malformed, "source or target is not UTF-8");
  if (size != frame.size() - offset) return fail(Errc::malformed, "size differs from the data's length");
  if (size > kMaxDataSize) return fail(Errc::too_large, "data of " + std::to_string(size) + " bytes");
  view.data = frame.substr(offset);
  return view;
}

Message to_message(const HeaderView& view) {
  return {.type = view.type,
          .flags = view.flags,
          .remaining_ms = view.remaining_ms,
          .subtype = std::string(view.subtype),
          .source = std::string(view.source),
          .target = std::string(view.target),
          .id = view.id,
          .reply_to = view.reply_to,
          .data = Bytes(view.data)};
}

HeaderView to_view(const Message& message) {
  return {.type = message.type,
          .flags = message.flags,
          .remaining_ms = message.remaining_ms,
          .subtype = message.subtype,
          .source = message.source,
          .target = message.target,
          .id = message.id,
          .reply_to = message.reply_to,
          .data = message.data};
}

std::uint32_t decode_remaining(BytesView frame) {
  return get_big_endian<std::uint32_t>(frame.data() + 4);
}

void stamp_version(char* frame, std::uint8_t version) {
  put_big_endian<std::uint8_t>(frame, version);
}

void stamp_remaining(char* frame, std::uint32_t remaining_ms) {
  put_big_endian<std::uint32_t>(frame + 4, remaining_ms);
}

void stamp_link(char* frame, std::uint64_t link, std::uint64_t sequence, std::uint32_t remaining_ms) {
  stamp_remaining(frame, remaining_ms);
  put_big_endian<std::uint64_t>(frame + 8, link);
  put_big_endian<std::uint64_t>(frame + 16, sequence);
}

}  // namespace trb
