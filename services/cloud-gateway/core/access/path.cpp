#include "services/cloud-gateway/core/access/path.hpp"

#include <algorithm>
#include <array>

#include "common/base/hex.hpp"

namespace trb::gateway {
namespace {

constexpr std::array<bool, 256> kMayStand = [] {
  std::array<bool, 256> out{};
  for (const char c : std::string_view("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-._~:@+,=!")) {
    out[static_cast<unsigned char>(c)] = true;
  }
  return out;
}();

bool may_stand(char c) {
  return kMayStand[static_cast<unsigned char>(c)];
}

Error refuse(std::string_view what) {
  return fail(Errc::malformed, "path: " + std::string(what), "take the paths of /api/v1/openapi.json as they are");
}

/// Decodes the two digits after a '%', in either case.
Result<char> unescape(std::string_view digits) {
  std::string lower(digits);
  for (char& c : lower)
    if (c >= 'A' && c <= 'F') c = static_cast<char>(c - 'A' + 'a');
  const auto byte = from_hex(lower);
  if (!byte || byte->size() != 1) return refuse("a '%' without two hexadecimal digits");
  return byte->front();
}

Result<std::string> decode_segment(std::string_view raw) {
  std::string out;
  out.reserve(raw.size());
  for (std::size_t at = 0; at < raw.size(); ++at) {
    char c = raw[at];
    if (c == '%') {
      const auto byte = unescape(raw.substr(at + 1, 2));
      if (!byte) return byte.error();
      c = *byte;
      at += 2;
    }
    if (!may_stand(c)) return refuse("a character that no path of ours has");
    out += c;
  }
  if (out.empty()) return refuse("an empty segment");
  if (out == "." || out == "..") return refuse("a dot segment");
  if (out.size() > kMaxSegment) return fail(Errc::too_large, "path: a segment over 96 bytes");
  return out;
}

}  // namespace

Result<std::vector<std::string>> split_path(std::string_view target) {
  if (target.size() > kMaxTarget) return fail(Errc::too_large, "path: over 2048 bytes with its query");
  std::string_view rest = target.substr(0, target.find('?'));
  if (!rest.starts_with('/')) return refuse("no '/' at its beginning");
  std::vector<std::string> out;
  if (rest == "/") return out;
  out.reserve(kMaxSegments);
  while (!rest.empty()) {
    rest.remove_prefix(1);
    const std::size_t end = std::min(rest.find('/'), rest.size());
    auto segment = decode_segment(rest.substr(0, end));
    if (!segment) return segment.error();
    if (out.size() >= kMaxSegments) return fail(Errc::too_large, "path: over 8 segments");
    out.push_back(std::move(*segment));
    rest.remove_prefix(end);
  }
  return out;
}

}  // namespace trb::gateway
