// The msgpack codec of every body (see body.hpp).
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <msgpack.hpp>
#include <span>

#include "proto/body.hpp"
#include "proto/field_reader.hpp"
#include "proto/shape.hpp"
#include "proto/string_buffer.hpp"
#include "proto/value.hpp"

namespace trb {
namespace {

class Packer : public msgpack::packer<StringBuffer> {
 public:
  explicit Packer(StringBuffer& buffer) : packer(buffer), out_(buffer.out) {}

  /// Always as float 64: the library packs 1.0 as the integer 1 and loses the sign of -0.0, and digests depend on the
  /// bytes.
  void put_double(double value) {
    if (!std::isfinite(value)) refuse(Errc::bad_value, "not a finite number");
    const auto bits = std::bit_cast<std::uint64_t>(value);
    out_ += '\xcb';
    for (int shift = 56; shift >= 0; shift -= 8) out_ += static_cast<char>(bits >> static_cast<unsigned>(shift));
  }

  /// The field that is being packed, for refuse().
  void enter(std::string_view field) { field_ = field; }
  /// The reader would not accept this.
  void refuse(Errc code, std::string_view what) {
    if (error_.code == Errc::ok) error_ = fail(code, std::string(field_) + ": " + std::string(what));
  }
  [[nodiscard]] const Error& error() const { return error_; }

 private:
  Bytes& out_;
  std::string_view field_ = "body";
  Error error_;
};

// ---- packing

/// What is sent must be readable: a text over its bound is cut, and bytes that are not UTF-8 are replaced.
void put_text(Packer& packer, const std::string& value, std::uint32_t max) {
  if (value.size() > max || !is_utf8(value)) return put_text(packer, cut_utf8(value, max), max);
  packer.pack_str(static_cast<std::uint32_t>(value.size()));
  packer.pack_str_body(value.data(), static_cast<std::uint32_t>(value.size()));
}

void put(Packer& packer, const Shape& shape, const void* value, std::uint32_t max);

void put_blob(Packer& packer, const std::string& bytes, std::uint32_t max) {
  if (bytes.size() > max) packer.refuse(Errc::too_large, "over " + std::to_string(max) + " bytes");
  packer.pack_bin(static_cast<std::uint32_t>(bytes.size()));
  packer.pack_bin_body(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
}

void put_list(Packer& packer, const ListShape& shape, const void* value, std::uint32_t max) {
  const std::size_t size = shape.size(value);
  if (size > max) packer.refuse(Errc::too_large, "list over " + std::to_string(max) + " items");
  packer.pack_array(static_cast<std::uint32_t>(size));
  const void* at = shape.data(value);
  for (std::size_t i = 0; i < size; ++i, at = behind(at, shape.stride)) put(packer, *shape.item, at, kDefaultMaxSize);
}

void put_fields(Packer& packer, std::span<const FieldEntry> fields, const void* value) {
  packer.pack_array(static_cast<std::uint32_t>(fields.size()));
  for (const FieldEntry& f : fields) {
    packer.enter(f.name);
    put(packer, *f.shape, behind(value, f.offset), f.max);
  }
}

void put(Packer& packer, const Shape& shape, const void* value, std::uint32_t max) {
  switch (shape.kind) {
    case FieldKind::boolean:
      return void(as<bool>(value) ? packer.pack_true() : packer.pack_false());
    case FieldKind::enumeration:
    case FieldKind::uint16:
    case FieldKind::uint32:
    case FieldKind::uint64:
      return void(packer.pack_uint64(unsigned_of(shape.kind, value)));
    case FieldKind::int64:
      return void(packer.pack_int64(as<std::int64_t>(value)));
    case FieldKind::number:
      return packer.put_double(as<double>(value));
    case FieldKind::text:
      return put_text(packer, as<std::string>(value), max);
    case FieldKind::blob:
      return put_blob(packer, as<Blob>(value).bytes, max);
    case FieldKind::list:
      return put_list(packer, shape.list, value, max);
    case FieldKind::record:
      return put_fields(packer, shape.fields, value);
  }
}

// ---- unpacking: returns false after having set `error`

struct MsgpackReader : FieldReader<MsgpackReader, msgpack::object> {
  template <class T>
  bool take_integer(const msgpack::object& from, T& out);
  bool take_enum(std::span<const std::string_view> names, const msgpack::object& from, std::uint8_t& out);
  bool take_list(const ListShape& shape, const msgpack::object& from, void* out, std::uint32_t max);
  bool take_fields(std::span<const FieldEntry> fields, const msgpack::object& from, void* out);
  bool take_bool(const msgpack::object& from, bool& out);
  bool take_double(const msgpack::object& from, double& out);
  bool take_text(const msgpack::object& from, std::string& out, std::uint32_t max);
  bool take_blob(const msgpack::object& from, Blob& out, std::uint32_t max);
};

template <class T>
bool MsgpackReader::take_integer(const msgpack::object& from, T& out) {
  if (from.type == msgpack::type::POSITIVE_INTEGER &&
      from.via.u64 <= static_cast<std::uint64_t>(std::numeric_limits<T>::max())) {
    out = static_cast<T>(from.via.u64);
    return true;
  }
  if constexpr (std::is_signed_v<T>) {
    if (from.type == msgpack::type::NEGATIVE_INTEGER && from.via.i64 >= std::numeric_limits<T>::min()) {
      out = static_cast<T>(from.via.i64);
      return true;
    }
  }
  return refuse(Errc::malformed, "no whole number of its range");
}

bool MsgpackReader::take_bool(const msgpack::object& from, bool& out) {
  if (from.type != msgpack::type::BOOLEAN) return refuse(Errc::malformed, "neither true nor false");
  out = from.via.boolean;
  return true;
}

bool MsgpackReader::take_double(const msgpack::object& from, double& out) {
  // Packers of other languages send 1.0 as the integer 1.
  if (from.type == msgpack::type::POSITIVE_INTEGER) {
    out = static_cast<double>(from.via.u64);
  } else if (from.type == msgpack::type::NEGATIVE_INTEGER) {
    out = static_cast<double>(from.via.i64);
  } else if (from.type == msgpack::type::FLOAT64 || from.type == msgpack::type::FLOAT32) {
    out = from.via.f64;
  } else {
    return refuse(Errc::malformed, "no number");
  }
  return std::isfinite(out) || refuse(Errc::bad_value, "not a finite number");
}

bool MsgpackReader::take_text(const msgpack::object& from, std::string& out, std::uint32_t max) {
  if (from.type != msgpack::type::STR) return refuse(Errc::malformed, "no text");
  if (from.via.str.size > max) return refuse(Errc::too_large, "text over " + std::to_string(max) + " bytes");
  out.assign(from.via.str.ptr, from.via.str.size);
  return is_utf8(out) || refuse(Errc::malformed, "text is not UTF-8");
}

bool MsgpackReader::take_blob(const msgpack::object& from, Blob& out, std::uint32_t max) {
  if (from.type != msgpack::type::BIN) return refuse(Errc::malformed, "no bytes");
  if (from.via.bin.size > max) return refuse(Errc::too_large, "over " + std::to_string(max) + " bytes");
  out.bytes.assign(from.via.bin.ptr, from.via.bin.size);
  return true;
}

bool MsgpackReader::take_enum(std::span<const std::string_view> names, const msgpack::object& from, std::uint8_t& out) {
  std::uint8_t raw = 0;
  if (!take_integer(from, raw)) return false;
  if (raw >= names.size()) return refuse(Errc::bad_value, std::to_string(raw) + " is not one of its values");
  out = raw;
  return true;
}

bool MsgpackReader::take_list(const ListShape& shape, const msgpack::object& from, void* out, std::uint32_t max) {
  if (from.type != msgpack::type::ARRAY) return refuse(Errc::malformed, "no list");
  if (from.via.array.size > max) return refuse(Errc::too_large, "list over " + std::to_string(max) + " items");
  void* at = shape.renew(out, from.via.array.size);
  const std::size_t stem = path.size();
  for (std::uint32_t i = 0; i < from.via.array.size; ++i, at = behind(at, shape.stride)) {
    path += "[" + std::to_string(i) + "]";
    if (!take(*shape.item, from.via.array.ptr[i], at, kDefaultMaxSize)) return false;
    path.resize(stem);
  }
  return true;
}

bool MsgpackReader::take_fields(std::span<const FieldEntry> fields, const msgpack::object& from, void* out) {
  if (from.type != msgpack::type::ARRAY) return refuse(Errc::malformed, "no list of fields");
  const std::size_t stem = path.size();
  const std::size_t told = std::min<std::size_t>(fields.size(), from.via.array.size);
  for (std::size_t i = 0; i < told; ++i) {
    const FieldEntry& f = fields[i];
    if (stem > 0) path += '.';
    path += f.name;
    if (!take(*f.shape, from.via.array.ptr[i], behind(out, f.offset), f.max)) return false;
    path.resize(stem);
  }
  return true;
}

/// The object points into the bytes and the zone.
Result<msgpack::object> parse(BytesView bytes, msgpack::zone& zone, const DecodeLimits& limits) {
  if (bytes.size() > limits.bytes) return fail(Errc::too_large, "body of " + std::to_string(bytes.size()) + " bytes");
  try {
    std::size_t offset = 0;
    const msgpack::unpack_limit bound(limits.items, limits.items, limits.bytes, limits.bytes, limits.bytes,
                                      limits.depth);
    const auto reference = [](msgpack::type::object_type, std::size_t, void*) { return true; };
    const msgpack::object all = msgpack::unpack(zone, bytes.data(), bytes.size(), offset, reference, nullptr, bound);
    if (offset != bytes.size()) return fail(Errc::malformed, "body: bytes after its end");
    return all;
  } catch (const msgpack::size_overflow& problem) {
    return fail(Errc::too_large, std::string("body: ") + problem.what());
  } catch (const std::exception& problem) {
    return fail(Errc::malformed, std::string("body: no msgpack (") + problem.what() + ")");
  }
}

/// Bodies are packed into bytes that are used again, and copied out once they are whole. What a large one took is given
/// back.
struct Scratch {
  Scratch() { bytes.clear(); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    constexpr std::size_t kUsual = 64 * 1024;
    if (bytes.capacity() > kUsual) Bytes().swap(bytes);
  }
  static Bytes& of_thread() {
    thread_local Bytes bytes;
    return bytes;
  }
  Bytes& bytes = of_thread();
  StringBuffer buffer{bytes};
};

}  // namespace

Bytes pack(const Shape& shape, const void* value) {
  Scratch scratch;
  Packer packer(scratch.buffer);
  put(packer, shape, value, kDefaultMaxSize);
  return scratch.bytes;
}

Result<Bytes> pack_readable(const Shape& shape, const void* value) {
  Scratch scratch;
  const Bytes& out = scratch.bytes;
  Packer packer(scratch.buffer);
  put(packer, shape, value, kDefaultMaxSize);
  if (packer.error().code != Errc::ok) return packer.error();
  if (const std::size_t most = DecodeLimits{}.bytes; out.size() > most)
    return fail(Errc::too_large, std::to_string(out.size()) + " bytes, over " + std::to_string(most));
  return out;
}

Error unpack(const Shape& shape, BytesView bytes, void* value, const DecodeLimits& limits) {
  // Its first chunk is used again: it has eight kilobytes, and most bodies a few hundred bytes.
  thread_local msgpack::zone zone;
  struct Clear {
    msgpack::zone& zone;
    ~Clear() { zone.clear(); }
  } const clear{zone};
  const auto all = parse(bytes, zone, limits);
  if (!all) return all.error();
  MsgpackReader reader;
  reader.take(shape, *all, value, kDefaultMaxSize);
  return std::move(reader.error);
}

}  // namespace trb
