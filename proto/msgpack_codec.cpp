// The msgpack codec of every body (see body.hpp).
#include <bit>
#include <cmath>
#include <limits>
#include <msgpack.hpp>

#include "proto/body.hpp"
#include "proto/value.hpp"

namespace trb {
namespace {

struct StringBuffer {
  std::string& out;
  void write(const char* data, std::size_t size) { out.append(data, size); }
};
class Packer : public msgpack::packer<StringBuffer> {
 public:
  explicit Packer(StringBuffer& buffer) : packer(buffer), out_(buffer.out) {}

  /// Always as float 64: the library packs 1.0 as the integer 1 and loses the sign of -0.0, and digests rest on the
  /// bytes.
  void put_double(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    out_ += '\xcb';
    for (int shift = 56; shift >= 0; shift -= 8) out_ += static_cast<char>(bits >> static_cast<unsigned>(shift));
  }

 private:
  Bytes& out_;
};

// ---- packing

/// What is sent can be read: a text over its bound (a robot's long error) is cut, and bytes that are no UTF-8 replaced.
void put_text(Packer& packer, const std::string& value, std::uint32_t max) {
  if (value.size() > max || !is_utf8(value)) return put_text(packer, cut_utf8(value, max), max);
  packer.pack_str(static_cast<std::uint32_t>(value.size()));
  packer.pack_str_body(value.data(), static_cast<std::uint32_t>(value.size()));
}

template <class T>
void put(Packer& packer, const T& value, std::uint32_t max) {
  if constexpr (std::is_same_v<T, bool>) {
    value ? packer.pack_true() : packer.pack_false();
  } else if constexpr (std::is_enum_v<T>) {
    packer.pack_uint64(static_cast<std::uint64_t>(value));
  } else if constexpr (std::is_floating_point_v<T>) {
    packer.put_double(value);
  } else if constexpr (std::is_integral_v<T>) {
    if constexpr (std::is_signed_v<T>) {
      packer.pack_int64(value);
    } else {
      packer.pack_uint64(value);
    }
  } else if constexpr (std::is_same_v<T, std::string>) {
    put_text(packer, value, max);
  } else if constexpr (std::is_same_v<T, Blob>) {
    packer.pack_bin(static_cast<std::uint32_t>(value.bytes.size()));
    packer.pack_bin_body(value.bytes.data(), static_cast<std::uint32_t>(value.bytes.size()));
  } else if constexpr (IsVector<T>::value) {
    packer.pack_array(static_cast<std::uint32_t>(value.size()));
    for (const auto& item : value) put(packer, item, kDefaultMaxSize);
  } else {
    std::apply(
        [&](const auto&... fields) {
          packer.pack_array(sizeof...(fields));
          (put(packer, value.*(fields.member), fields.max), ...);
        },
        T::fields());
  }
}

// ---- unpacking: returns false after having set `error`

struct Reader {
  std::string path;
  Error error;

  bool refuse(Errc code, std::string_view what) {
    if (error.code == Errc::ok)
      error = fail(code, (path.empty() ? std::string("body") : path) + ": " + std::string(what));
    return false;
  }

  template <class T>
  bool take(const msgpack::object& from, T& out, std::uint32_t max);

 private:
  template <class T>
  bool take_integer(const msgpack::object& from, T& out);
  template <class T>
  bool take_list(const msgpack::object& from, std::vector<T>& out, std::uint32_t max);
  template <class T>
  bool take_fields(const msgpack::object& from, T& out);
  bool take_double(const msgpack::object& from, double& out);
  bool take_text(const msgpack::object& from, std::string& out, std::uint32_t max);
  bool take_blob(const msgpack::object& from, Blob& out, std::uint32_t max);
};

template <class T>
bool Reader::take_integer(const msgpack::object& from, T& out) {
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

bool Reader::take_double(const msgpack::object& from, double& out) {
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

bool Reader::take_text(const msgpack::object& from, std::string& out, std::uint32_t max) {
  if (from.type != msgpack::type::STR) return refuse(Errc::malformed, "no text");
  if (from.via.str.size > max) return refuse(Errc::too_large, "text over " + std::to_string(max) + " bytes");
  out.assign(from.via.str.ptr, from.via.str.size);
  return is_utf8(out) || refuse(Errc::malformed, "text is not UTF-8");
}

bool Reader::take_blob(const msgpack::object& from, Blob& out, std::uint32_t max) {
  if (from.type != msgpack::type::BIN) return refuse(Errc::malformed, "no bytes");
  if (from.via.bin.size > max) return refuse(Errc::too_large, "over " + std::to_string(max) + " bytes");
  out.bytes.assign(from.via.bin.ptr, from.via.bin.size);
  return true;
}

template <class T>
bool Reader::take_list(const msgpack::object& from, std::vector<T>& out, std::uint32_t max) {
  if (from.type != msgpack::type::ARRAY) return refuse(Errc::malformed, "no list");
  if (from.via.array.size > max) return refuse(Errc::too_large, "list over " + std::to_string(max) + " items");
  out.clear();
  out.reserve(from.via.array.size);
  const std::size_t stem = path.size();
  for (std::uint32_t i = 0; i < from.via.array.size; ++i) {
    path += "[" + std::to_string(i) + "]";
    if (!take(from.via.array.ptr[i], out.emplace_back(), kDefaultMaxSize)) return false;
    path.resize(stem);
  }
  return true;
}

template <class T>
bool Reader::take_fields(const msgpack::object& from, T& out) {
  if (from.type != msgpack::type::ARRAY) return refuse(Errc::malformed, "no list of fields");
  std::uint32_t index = 0;
  const std::size_t stem = path.size();
  const auto one = [&](const auto& f) {
    if (index >= from.via.array.size) return true;
    if (stem > 0) path += '.';
    path += f.name;
    const bool good = take(from.via.array.ptr[index++], out.*(f.member), f.max);
    if (good) path.resize(stem);
    return good;
  };
  return std::apply([&](const auto&... f) { return (one(f) && ...); }, T::fields());
}

template <class T>
bool Reader::take(const msgpack::object& from, T& out, std::uint32_t max) {
  if constexpr (std::is_same_v<T, bool>) {
    if (from.type != msgpack::type::BOOLEAN) return refuse(Errc::malformed, "neither true nor false");
    out = from.via.boolean;
    return true;
  } else if constexpr (std::is_enum_v<T>) {
    std::uint8_t raw = 0;
    if (!take_integer(from, raw)) return false;
    if (raw >= enum_names(T{}).size()) return refuse(Errc::bad_value, std::to_string(raw) + " is none of its values");
    out = static_cast<T>(raw);
    return true;
  } else if constexpr (std::is_integral_v<T>) {
    return take_integer(from, out);
  } else if constexpr (std::is_floating_point_v<T>) {
    return take_double(from, out);
  } else if constexpr (std::is_same_v<T, std::string>) {
    return take_text(from, out, max);
  } else if constexpr (std::is_same_v<T, Blob>) {
    return take_blob(from, out, max);
  } else if constexpr (IsVector<T>::value) {
    return take_list(from, out, max);
  } else {
    return take_fields(from, out);
  }
}

Result<msgpack::object_handle> parse(BytesView bytes) {
  const DecodeLimits limits;
  if (bytes.size() > limits.bytes) return fail(Errc::too_large, "body of " + std::to_string(bytes.size()) + " bytes");
  try {
    std::size_t offset = 0;
    const msgpack::unpack_limit bound(limits.items, limits.items, limits.bytes, limits.bytes, limits.bytes,
                                      limits.depth);
    const auto reference = [](msgpack::type::object_type, std::size_t, void*) { return true; };
    msgpack::object_handle handle = msgpack::unpack(bytes.data(), bytes.size(), offset, reference, nullptr, bound);
    if (offset != bytes.size()) return fail(Errc::malformed, "body: bytes after its end");
    return handle;
  } catch (const msgpack::size_overflow& problem) {
    return fail(Errc::too_large, std::string("body: ") + problem.what());
  } catch (const std::exception& problem) {
    return fail(Errc::malformed, std::string("body: no msgpack (") + problem.what() + ")");
  }
}

}  // namespace

template <class T>
Bytes encode(const T& body) {
  Bytes out;
  StringBuffer buffer{out};
  Packer packer(buffer);
  put(packer, body, kDefaultMaxSize);
  return out;
}

template <class T>
Result<T> decode(BytesView bytes) {
  auto handle = parse(bytes);
  if (!handle) return handle.error();
  Reader reader;
  T out{};
  if (!reader.take(handle->get(), out, kDefaultMaxSize)) return reader.error;
  return out;
}

#define TRB_INSTANTIATE(Name)         \
  template Bytes encode(const Name&); \
  template Result<Name> decode(BytesView);
TRB_BODIES(TRB_INSTANTIATE)
#undef TRB_INSTANTIATE

}  // namespace trb
