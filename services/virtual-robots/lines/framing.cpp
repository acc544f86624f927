#include "services/virtual-robots/lines/framing.hpp"

#include <algorithm>
#include <cstdint>

namespace trb::virtual_robots::lines {
namespace {

constexpr std::size_t kPrefix = 4;

/** Parts of the delay: a border is seen after half of it, so that a late sender or reader costs no border. */
constexpr double kBorderShare = 0.5;

std::string escape_of(char c) {
  if (c == '\\') return "\\\\";
  if (c == '\n') return "\\n";
  if (c == '\r') return "\\r";
  return {c};
}

Field unescape(std::string_view line) {
  Field field;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char next = i + 1 < line.size() ? line[i + 1] : '\0';
    if (line[i] != '\\') {
      field.text += line[i];
    } else if (next == '\\' || next == 'n' || next == 'r') {
      field.text += next == 'n' ? '\n' : next == 'r' ? '\r' : '\\';
      ++i;
    } else {
      field.text += '\\';
      field.bad_escape = true;
    }
  }
  return field;
}

std::size_t counted_size(const std::string& buffer, std::size_t at) {
  std::uint32_t size = 0;
  for (std::size_t i = 0; i < kPrefix; ++i) size = (size << 8) | static_cast<unsigned char>(buffer[at + i]);
  return size;
}

std::string prefix_of(std::size_t size) {
  std::string out;
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>((size >> shift) & 0xff);
  return out;
}

}  // namespace

std::optional<Framing> parse_framing(std::string_view name) {
  if (name == "newline") return Framing::newline;
  if (name == "length") return Framing::length;
  if (name == "delay") return Framing::delay;
  return std::nullopt;
}

void FieldReader::add(std::string_view bytes, double now) {
  if (overflowed_ || bytes.empty()) return;
  compact();
  buffer_ += bytes;
  last_byte_ = now;
}

std::optional<Field> FieldReader::next(double now) {
  if (overflowed_) return std::nullopt;
  auto field = rules_.framing == Framing::newline  ? next_line()
               : rules_.framing == Framing::length ? next_counted()
                                                   : next_burst(now);
  if (!field) compact();
  return field;
}

std::optional<Field> FieldReader::next_line() {
  const std::size_t end = buffer_.find('\n', std::max(used_, searched_));
  searched_ = buffer_.size();
  const std::size_t size = (end == std::string::npos ? buffer_.size() : end) - used_;
  overflowed_ = size > kLargestField;
  if (overflowed_ || end == std::string::npos) return std::nullopt;
  std::string line = take(used_, size, size + 1);
  searched_ = used_;
  if (line.ends_with('\r')) line.pop_back();
  Field field = unescape(line);
  field.longer_than_chunk = rules_.chunk_bytes != 0 && line.size() > rules_.chunk_bytes;
  return field;
}

std::optional<Field> FieldReader::next_counted() {
  const std::size_t held = buffer_.size() - used_;
  if (held < kPrefix) return std::nullopt;
  const std::size_t size = counted_size(buffer_, used_);
  overflowed_ = size > kLargestField;
  if (overflowed_ || held < kPrefix + size) return std::nullopt;
  return Field{take(used_ + kPrefix, size, kPrefix + size), rules_.chunk_bytes != 0 && size > rules_.chunk_bytes};
}

std::optional<Field> FieldReader::next_burst(double now) {
  const std::size_t size = buffer_.size() - used_;
  overflowed_ = size > kLargestField;
  const auto border = next_deadline();
  if (overflowed_ || !border || now < *border) return std::nullopt;
  return Field{take(used_, size, size), rules_.chunk_bytes != 0 && size > rules_.chunk_bytes};
}

std::optional<double> FieldReader::next_deadline() const {
  if (rules_.framing != Framing::delay || buffer_.size() == used_) return std::nullopt;
  return last_byte_ + rules_.delay_s * kBorderShare;
}

std::string FieldReader::take(std::size_t begin, std::size_t size, std::size_t used) {
  used_ += used;
  return buffer_.substr(begin, size);
}

/** Drops what was returned already; once per read, not once per field, so that many short fields stay cheap. */
void FieldReader::compact() {
  buffer_.erase(0, used_);
  searched_ -= std::min(searched_, used_);
  used_ = 0;
}

void FieldReader::clear() {
  buffer_.clear();
  used_ = searched_ = 0;
  overflowed_ = false;
}

std::string frame_field(std::string_view field, const FrameRules& rules) {
  if (rules.framing == Framing::delay) return std::string(field);
  if (rules.framing == Framing::length) return prefix_of(field.size()) + std::string(field);
  std::string line;
  for (const char c : field) line += escape_of(c);
  return line + '\n';
}

std::vector<std::string> frame_data(std::string_view data, const FrameRules& rules) {
  std::vector<std::string> chunks;
  std::size_t begin = 0;
  std::size_t framed = 0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const std::size_t cost = rules.framing == Framing::newline ? escape_of(data[i]).size() : 1;
    if (rules.chunk_bytes != 0 && i > begin && framed + cost > rules.chunk_bytes) {
      chunks.push_back(frame_field(data.substr(begin, i - begin), rules));
      begin = i;
      framed = 0;
    }
    framed += cost;
  }
  chunks.push_back(frame_field(data.substr(begin), rules));
  return chunks;
}

}  // namespace trb::virtual_robots::lines
