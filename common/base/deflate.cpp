#include "common/base/deflate.hpp"

#include <zlib.h>

#include <algorithm>
#include <new>
#include <string>

namespace trb {
namespace {

/// What is written at a time: a sender of few bytes that become many is refused early.
constexpr std::size_t kStep = 16384;

}  // namespace

Bytes deflated(BytesView bytes) {
  uLongf size = compressBound(bytes.size());
  Bytes out(size, '\0');
  // With the bound's room it cannot fail but for want of memory.
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(),
                Z_BEST_COMPRESSION) != Z_OK) {
    throw std::bad_alloc();
  }
  out.resize(size);
  return out;
}

Result<Bytes> inflated(BytesView bytes, std::size_t most) {
  z_stream stream{};
  // zlib does not write into its input.
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  if (inflateInit(&stream) != Z_OK) throw std::bad_alloc();
  Bytes out;
  int state = Z_OK;
  while (state == Z_OK && out.size() <= most) {
    const std::size_t before = out.size();
    out.resize(before + std::min(kStep, most + 1 - before));
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream.avail_out = static_cast<uInt>(out.size() - before);
    state = ::inflate(&stream, Z_NO_FLUSH);
    out.resize(out.size() - stream.avail_out);
  }
  const bool is_whole = state == Z_STREAM_END && stream.avail_in == 0;
  inflateEnd(&stream);
  if (out.size() > most) return fail(Errc::too_large, "deflated bytes: more than " + std::to_string(most));
  if (!is_whole) return fail(Errc::malformed, "deflated bytes: malformed or cut");
  return out;
}

}  // namespace trb
