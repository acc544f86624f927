#include <sodium.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "services/ros-bridge/core/message_codec.hpp"
#include "services/ros-bridge/core/wire_bytes.hpp"

namespace trb::ros {
namespace {

/// Elements that take no place on the wire (std_msgs/Empty[]) are bounded too, and so is what a byte becomes in JSON.
constexpr std::size_t kMaxElements = 100'000;

std::string base64_of(BytesView bytes) {
  std::string out(sodium_base64_ENCODED_LEN(bytes.size(), sodium_base64_VARIANT_ORIGINAL), '\0');
  sodium_bin2base64(out.data(), out.size(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(),
                    sodium_base64_VARIANT_ORIGINAL);
  out.pop_back();
  return out;
}

bool begins_in(std::string_view path, std::string_view field) {
  if (path.starts_with('.')) path.remove_prefix(1);
  return path.substr(0, path.find_first_of(".[")) == field;
}

/// Reads one message; the first fault ends it.
class Reader {
 public:
  explicit Reader(BytesView wire) : rest_(wire) {}

  /// Of the fields that no path begins in nothing is kept.
  Value message(const RosType& type, const std::vector<std::string>& paths) {
    Value::Object out{};
    for (const Field& field : type.fields) {
      if (fault_) break;
      skips_ = !paths.empty() &&
               std::ranges::none_of(paths, [&](const std::string& path) { return begins_in(path, field.name); });
      path_ = field.name;
      Value value = any(field);
      if (!skips_) out.emplace_back(field.name, std::move(value));
    }
    return Value{std::move(out)};
  }

  Value message(const RosType& type) {
    Value::Object out{};
    for (const Field& field : type.fields) {
      if (fault_) break;
      const std::size_t before = path_.size();
      path_ += (path_.empty() ? "" : ".") + field.name;
      out.emplace_back(field.name, any(field));
      if (!fault_) path_.resize(before);
    }
    return Value{std::move(out)};
  }

  /// The first fault, if there is one: also what stands behind the message.
  std::optional<Error> fault(const RosType& type) {
    if (!fault_ && !rest_.empty()) {
      return fail(Errc::malformed, type.name + ": " + std::to_string(rest_.size()) + " bytes behind its end");
    }
    return fault_;
  }

 private:
  void refuse(Errc code, const std::string& what) {
    if (!fault_) fault_ = fail(code, path_ + ": " + what);
  }

  BytesView take(std::size_t size) {
    if (rest_.size() < size) {
      refuse(Errc::malformed, "the message ends in it");
      return {};
    }
    const BytesView taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }
  template <class U>
  U number() {
    const BytesView taken = take(sizeof(U));
    return taken.empty() ? U{0} : get_little<U>(taken);
  }

  Value any(const Field& field) { return field.array ? array(field) : one(field); }

  Value array(const Field& field) {
    const std::size_t size = field.length ? *field.length : number<std::uint32_t>();
    if (field.primitive == Primitive::uint8) {
      const BytesView bytes = take(size);
      return skips_ ? Value{nullptr} : Value{base64_of(bytes)};
    }
    const std::size_t least = field.message ? field.message->least_size : 1;
    if (size * std::max<std::size_t>(least, 1) > rest_.size() && least > 0) {
      refuse(Errc::malformed, "the message ends in it");
      return Value{nullptr};
    }
    if (skips_) return skipped(field, least == 0 ? 0 : size);
    elements_ += size;
    if (elements_ > kMaxElements) {
      refuse(Errc::too_large, "more than " + std::to_string(kMaxElements) + " elements");
      return Value{nullptr};
    }
    Value::List out;
    out.reserve(size);
    const std::size_t before = path_.size();
    for (std::size_t i = 0; i < size && !fault_; ++i) {
      path_ += "[" + std::to_string(i) + "]";
      out.push_back(one(field));
      if (!fault_) path_.resize(before);
    }
    return Value{std::move(out)};
  }

  Value skipped(const Field& field, std::size_t size) {
    for (std::size_t i = 0; i < size && !fault_; ++i) one(field);
    return Value{nullptr};
  }

  template <class T>
  Value integer() {
    const auto read = static_cast<T>(number<std::make_unsigned_t<T>>());
    if (!std::in_range<std::int64_t>(read)) return Value{std::to_string(read)};
    return Value{static_cast<std::int64_t>(read)};
  }

  template <class T, class Bits>
  Value real() {
    const T read = std::bit_cast<T>(number<Bits>());
    if (!std::isfinite(read)) return Value{nullptr};
    return Value{static_cast<double>(read)};
  }

  Value text() {
    const BytesView bytes = take(number<std::uint32_t>());
    if (is_utf8(bytes)) return Value{std::string(bytes)};
    Value::Object out{};
    out.emplace_back("base64", Value{base64_of(bytes)});
    return Value{std::move(out)};
  }

  template <class T>
  Value time() {
    Value::Object out{};
    out.emplace_back("secs", integer<T>());
    out.emplace_back("nsecs", integer<T>());
    return Value{std::move(out)};
  }

  Value one(const Field& field) {
    if (field.message) return message(*field.message);
    switch (field.primitive) {
      case Primitive::boolean: {
        const auto read = number<std::uint8_t>();
        if (read > 1) refuse(Errc::malformed, std::to_string(read) + " is no bool");
        return Value{read == 1};
      }
      case Primitive::int8:
        return integer<std::int8_t>();
      case Primitive::uint8:
        return integer<std::uint8_t>();
      case Primitive::int16:
        return integer<std::int16_t>();
      case Primitive::uint16:
        return integer<std::uint16_t>();
      case Primitive::int32:
        return integer<std::int32_t>();
      case Primitive::uint32:
        return integer<std::uint32_t>();
      case Primitive::int64:
        return integer<std::int64_t>();
      case Primitive::uint64:
        return integer<std::uint64_t>();
      case Primitive::float32:
        return real<float, std::uint32_t>();
      case Primitive::float64:
        return real<double, std::uint64_t>();
      case Primitive::string:
        return text();
      case Primitive::time:
        return time<std::uint32_t>();
      case Primitive::duration:
        return time<std::int32_t>();
      default:
        return Value{nullptr};
    }
  }

  BytesView rest_;
  std::string path_;
  std::size_t elements_ = 0;
  bool skips_ = false;  ///< nobody wants the field
  std::optional<Error> fault_;
};

}  // namespace

Result<Value> to_json(const RosType& type, BytesView wire, const std::vector<std::string>& paths) {
  if (wire.size() > kMaxMessage) return fail(Errc::too_large, type.name + ": a message of over 1 MiB");
  Reader reader(wire);
  Value out = reader.message(type, paths);
  if (auto fault = reader.fault(type)) return *fault;
  return out;
}

}  // namespace trb::ros
