#include "services/cloud-gateway/io/api/gzip.hpp"

#include <zlib.h>

#include <algorithm>

namespace trb::gateway {
namespace {

constexpr int kGzip = 15 + 16;  ///< zlib: the largest window, with a gzip header
constexpr int kMemory = 8;

bool is_text(const std::string& type) {
  return type.starts_with("application/json") || type.starts_with("text/") || type == "application/x-ndjson";
}

bool has(const HttpReply& reply, std::string_view name) {
  return std::ranges::any_of(reply.headers, [&](const auto& header) { return header.first == name; });
}

}  // namespace

Bytes gzipped(BytesView bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) != Z_OK) return {};
  Bytes out(deflateBound(&stream, bytes.size()), '\0');
  // zlib does not write into its input.
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const bool is_whole = deflate(&stream, Z_FINISH) == Z_STREAM_END;
  out.resize(is_whole ? stream.total_out : 0);
  deflateEnd(&stream);
  return out;
}

bool may_zip(const Route& route) {
  constexpr std::string_view kSecret[] = {"/api/v1/session", "/api/v1/me", "/api/v1/tokens"};
  return route.effect == Effect::reads && std::ranges::find(kSecret, route.path) == std::end(kSecret);
}

void zip(const Route& route, bool accepts_gzip, HttpReply& reply) {
  if (!may_zip(route) || reply.body == nullptr || !is_text(reply.content_type)) return;
  if (has(reply, "ETag") || has(reply, "Content-Encoding")) return;
  reply.headers.emplace_back("Vary", "Accept-Encoding");
  if (!accepts_gzip || reply.body->size() < kLeastZipped || reply.body->size() > kMostZipped) return;
  Bytes smaller = gzipped(*reply.body);
  if (smaller.empty() || smaller.size() >= reply.body->size()) return;
  reply.body = std::make_shared<const Bytes>(std::move(smaller));
  reply.headers.emplace_back("Content-Encoding", "gzip");
}

}  // namespace trb::gateway
