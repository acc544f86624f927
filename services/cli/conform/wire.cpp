#include "services/cli/conform/wire.hpp"

#include <algorithm>
#include <cstdio>

#include "proto/message.hpp"

namespace trb::cli::conform {
namespace {

constexpr std::size_t kPrefix = 4;
constexpr std::size_t kShown = 60;

std::string escaped(char c) {
  if (c == '\\') return "\\\\";
  if (c == '\n') return "\\n";
  return c == '\r' ? "\\r" : std::string(1, c);
}

bool is_order(std::string_view chunk, const FieldChannel& channel) {
  if (channel.encoding == Encoding::numeric) return chunk == "-1" || chunk == "-2";
  return chunk == "!stop" || chunk == "!release";
}

Field unescaped(std::string_view line) {
  Field out;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] != '\\') {
      out.text += line[i];
      continue;
    }
    const char next = ++i < line.size() ? line[i] : ' ';
    if (next != '\\' && next != 'n' && next != 'r') out.fault = "a '\\' that is followed by neither '\\', 'n' nor 'r'";
    out.text += next == 'n' ? '\n' : next == 'r' ? '\r' : next;
  }
  return out;
}

}  // namespace

std::string framed(std::string_view field, const FieldChannel& channel) {
  std::string out;
  if (channel.framing == Framing::delay) return std::string(field);
  if (channel.framing == Framing::length) {
    for (const int shift : {24, 16, 8, 0}) out += static_cast<char>((field.size() >> shift) & 0xffU);
    return out + std::string(field);
  }
  for (const char c : field) out += escaped(c);
  return out + '\n';
}

std::vector<std::string> chunks_of(std::string_view data, const FieldChannel& channel) {
  std::vector<std::string> out;
  std::size_t begin = 0;
  do {
    std::size_t end = begin;
    for (std::size_t used = 0; end < data.size(); ++end) {
      used += channel.framing == Framing::newline ? escaped(data[end]).size() : 1;
      if (channel.chunk_bytes != 0 && used > channel.chunk_bytes && end > begin) break;
    }
    if (is_order(data.substr(begin, end - begin), channel)) --end;
    out.push_back(framed(data.substr(begin, end - begin), channel));
    begin = end;
  } while (begin < data.size());
  return out;
}

std::optional<Field> Cutter::next(bool pause) {
  if (channel_.framing == Framing::newline) return next_line();
  if (channel_.framing == Framing::length) return next_counted();
  if (!pause || held_.empty()) return std::nullopt;
  Field out{std::move(held_), ""};
  held_.clear();
  return out;
}

std::optional<Field> Cutter::next_line() {
  const std::size_t end = held_.find('\n');
  if (end == std::string::npos) return std::nullopt;
  std::string_view line = std::string_view(held_).substr(0, end);
  if (line.ends_with('\r')) line.remove_suffix(1);
  Field out = unescaped(line);
  if (channel_.chunk_bytes != 0 && line.size() > channel_.chunk_bytes) {
    out.fault =
        "a field of " + std::to_string(line.size()) + " bytes; chunk_bytes is " + std::to_string(channel_.chunk_bytes);
  }
  held_.erase(0, end + 1);
  return out;
}

std::optional<Field> Cutter::next_counted() {
  if (held_.size() < kPrefix) return std::nullopt;
  std::size_t size = 0;
  for (std::size_t i = 0; i < kPrefix; ++i) size = (size << 8U) | static_cast<unsigned char>(held_[i]);
  if (size > 2 * kMaxDataSize) return Field{"", "a length of " + std::to_string(size) + " bytes"};
  if (held_.size() < kPrefix + size) return std::nullopt;
  Field out{held_.substr(kPrefix, size), ""};
  held_.erase(0, kPrefix + size);
  return out;
}

std::string shown(std::string_view text) {
  std::string out = "'";
  for (const char c : text.substr(0, kShown)) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\n' || c == '\r' || c == '\\') {
      out += escaped(c);
    } else if (byte < 0x20 || byte == 0x7f) {
      char hex[8];
      std::snprintf(hex, sizeof hex, "\\x%02x", byte);
      out += hex;
    } else {
      out += c;
    }
  }
  out = cut_utf8(out, out.size()) + "'";
  return text.size() > kShown ? out + "... (" + std::to_string(text.size()) + " bytes)" : out;
}

}  // namespace trb::cli::conform
