#include "common/drivers/lines/frame.hpp"

#include <algorithm>

#include "proto/message.hpp"

namespace trb::drivers {
namespace {

constexpr std::size_t kPrefix = 4;
/// A whole message's data, every byte of it escaped.
constexpr std::size_t kMaxField = 2 * kMaxDataSize + 16;
/// Half a pause counts as a border, so that a late sender costs none.
constexpr double kBorderShare = 0.5;

bool needs_escape(char c) {
  return c == '\\' || c == '\n' || c == '\r';
}

char escaped(char c) {
  if (c == '\n') return 'n';
  return c == '\r' ? 'r' : c;
}

std::size_t prefix_at(BytesView bytes) {
  std::size_t size = 0;
  for (std::size_t i = 0; i < kPrefix; ++i) size = (size << 8U) | static_cast<unsigned char>(bytes[i]);
  return size;
}

void append_escaped(Bytes& out, BytesView field) {
  for (const char c : field) {
    if (needs_escape(c)) out += '\\';
    out += escaped(c);
  }
}

}  // namespace

FieldReader::FieldReader(const FieldChannel& settings)
    : framing_(settings.framing), border_(seconds(settings.delay_s * kBorderShare)) {}

void FieldReader::add(BytesView bytes, MonotonicTime now) {
  if (overflowed_ || bytes.empty()) return;
  buffer_.erase(0, used_);
  searched_ -= std::min(searched_, used_);
  used_ = 0;
  buffer_ += bytes;
  last_byte_ = now;
}

std::optional<std::string_view> FieldReader::next(MonotonicTime now) {
  if (overflowed_) return std::nullopt;
  switch (framing_) {
    case Framing::newline:
      return next_line();
    case Framing::length:
      return next_counted();
    case Framing::delay:
      break;
  }
  return next_burst(now);
}

std::optional<std::string_view> FieldReader::next_line() {
  const std::size_t from = std::max(used_, searched_);
  const std::size_t end = BytesView(buffer_).find('\n', from);
  const std::size_t stop = std::min(end, buffer_.size());
  searched_ = stop;
  overflowed_ = stop - used_ > kMaxField;
  if (overflowed_ || end == BytesView::npos) return std::nullopt;
  searched_ = stop + 1;
  std::string_view line = take(used_, stop - used_, stop + 1 - used_);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line.find('\\') == std::string_view::npos ? line : unescape(line);
}

std::string_view FieldReader::unescape(std::string_view line) {
  unescaped_.clear();
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char next = i + 1 < line.size() ? line[i + 1] : '\0';
    const bool escape = line[i] == '\\' && (next == '\\' || next == 'n' || next == 'r');
    if (!escape) {
      unescaped_ += line[i];
      continue;
    }
    unescaped_ += next == 'n' ? '\n' : (next == 'r' ? '\r' : '\\');
    ++i;
  }
  return unescaped_;
}

std::optional<std::string_view> FieldReader::next_counted() {
  const std::size_t held = buffer_.size() - used_;
  if (held < kPrefix) return std::nullopt;
  const std::size_t size = prefix_at(BytesView(buffer_).substr(used_));
  overflowed_ = size > kMaxField;
  if (overflowed_ || held < kPrefix + size) return std::nullopt;
  return take(used_ + kPrefix, size, kPrefix + size);
}

std::optional<std::string_view> FieldReader::next_burst(MonotonicTime now) {
  const std::size_t size = buffer_.size() - used_;
  overflowed_ = size > kMaxField;
  const auto border = next_deadline();
  if (overflowed_ || !border || now < *border) return std::nullopt;
  return take(used_, size, size);
}

std::string_view FieldReader::take(std::size_t begin, std::size_t size, std::size_t used) {
  used_ += used;
  return std::string_view(buffer_).substr(begin, size);
}

std::optional<MonotonicTime> FieldReader::next_deadline() const {
  if (framing_ != Framing::delay || buffer_.size() == used_) return std::nullopt;
  return last_byte_ + border_;
}

void FieldReader::clear() {
  buffer_.clear();
  used_ = searched_ = 0;
  overflowed_ = false;
}

void append_field(Bytes& out, BytesView field, Framing framing) {
  switch (framing) {
    case Framing::newline:
      append_escaped(out, field);
      out += '\n';
      break;
    case Framing::length:
      for (unsigned shift = 32; shift != 0; shift -= 8) out += static_cast<char>((field.size() >> (shift - 8)) & 0xffU);
      out += field;
      break;
    case Framing::delay:
      out += field;
      break;
  }
}

namespace {

/// A chunk of data that the robot would take for `!stop` or `!release`.
bool reads_as_order(BytesView chunk, Encoding encoding) {
  if (encoding == Encoding::numeric) return chunk == "-1" || chunk == "-2";
  return chunk == "!stop" || chunk == "!release";
}

std::size_t limit_end(BytesView data, std::size_t begin, const FieldChannel& settings) {
  if (settings.chunk_bytes == 0) return data.size();
  const bool escapes = settings.framing == Framing::newline;
  std::size_t framed = 0;
  std::size_t end = begin;
  for (; end < data.size(); ++end) {
    framed += escapes && needs_escape(data[end]) ? 2 : 1;
    // At least one byte a chunk, or a limit of 1 would never get past an escape.
    if (framed > settings.chunk_bytes && end > begin) break;
  }
  return end;
}

}  // namespace

std::size_t chunk_end(BytesView data, std::size_t begin, const FieldChannel& settings) {
  const std::size_t end = limit_end(data, begin, settings);
  return reads_as_order(data.substr(begin, end - begin), settings.encoding) ? end - 1 : end;
}

}  // namespace trb::drivers
