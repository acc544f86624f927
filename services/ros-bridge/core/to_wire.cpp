#include <sodium.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

#include "common/base/number_text.hpp"
#include "proto/value_words.hpp"
#include "services/ros-bridge/core/message_codec.hpp"
#include "services/ros-bridge/core/wire_bytes.hpp"

namespace trb::ros {
namespace {

std::string kinds(const Value& value) {
  return in_words(value);
}

/// What others write for a number that is not finite.
bool is_no_number(const Value& json) {
  constexpr std::array<std::string_view, 8> kWords = {"nan",  "-nan",     "inf",       "+inf",
                                                      "-inf", "infinity", "+infinity", "-infinity"};
  if (!json.is_text()) return false;
  std::string word = json.text().substr(0, 10);
  std::ranges::transform(word, word.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return std::ranges::find(kWords, word) != kWords.end();
}

/// Writes one message; remembers where it is for the error.
class Writer {
 public:
  Status message(const RosType& type, const Value& json) {
    if (!json.is_object()) return wrong(json, "an object of " + type.name);
    for (const auto& [key, member] : json.object()) {
      const bool known =
          std::ranges::any_of(type.fields, [&name = key](const Field& field) { return field.name == name; });
      if (!known) return refuse(Errc::unknown_key, key.substr(0, 60) + ": no field of " + type.name, has(type));
    }
    for (const Field& field : type.fields) {
      const std::size_t before = path_.size();
      path_ += (path_.empty() ? "" : ".") + field.name;
      if (auto put = any(field, json.find(field.name)); !put) return put;
      path_.resize(before);
    }
    return Done{};
  }

  /// Takes the values of the message from the front of the list, which is long enough.
  Status flat(const RosType& type, std::span<const Value>& values) {
    for (const Field& field : type.fields) {
      const std::size_t before = path_.size();
      path_ += (path_.empty() ? "" : ".") + field.name;
      for (std::uint32_t i = 0; i < field.length.value_or(1); ++i) {
        if (auto put = flat_one(field, values); !put) return put;
      }
      path_.resize(before);
    }
    return Done{};
  }

  [[nodiscard]] std::size_t size() const { return out_.size(); }
  [[nodiscard]] Bytes take() { return std::move(out_); }

 private:
  [[nodiscard]] Error refuse(Errc code, const std::string& what, std::string hint = {}) const {
    return fail(code, (path_.empty() ? "" : path_ + ": ") + what, std::move(hint));
  }
  [[nodiscard]] Error wrong(const Value& value, const std::string& wanted) const {
    return refuse(Errc::bad_value, kinds(value) + ", where " + wanted + " is needed");
  }
  static std::string has(const RosType& type) {
    std::string names;
    for (const Field& field : type.fields) names += (names.empty() ? "" : ", ") + field.name;
    return names.empty() ? "it has no fields" : "it has " + names;
  }

  Status flat_one(const Field& field, std::span<const Value>& values) {
    if (field.message) return flat(*field.message, values);
    if (field.primitive == Primitive::time || field.primitive == Primitive::duration) {
      Value::Object time;
      time.emplace_back("secs", values[0]);
      time.emplace_back("nsecs", values[1]);
      values = values.subspan(2);
      return primitive(field.primitive, Value{std::move(time)});
    }
    const Value& value = values.front();
    values = values.subspan(1);
    return primitive(field.primitive, value);
  }

  /// A field with its array, if it is one; none: zeros.
  Status any(const Field& field, const Value* json) {
    if (out_.size() > kMaxMessage) return refuse(Errc::too_large, "the message is over 1 MiB");
    if (!field.array) return one(field, json);
    if (json == nullptr) return zeros(field);
    if (field.primitive == Primitive::uint8 && json->is_text()) return bytes(field, json->text());
    if (!json->is_list()) return wrong(*json, "a list");
    const Value::List& list = json->list();
    if (auto fits = length(field, list.size()); !fits) return fits;
    const std::size_t before = path_.size();
    for (std::size_t i = 0; i < list.size(); ++i) {
      path_ += "[" + std::to_string(i) + "]";
      if (auto put = one(field, &list[i]); !put) return put;
      path_.resize(before);
      if (out_.size() > kMaxMessage) return refuse(Errc::too_large, "the message is over 1 MiB");
    }
    return Done{};
  }

  /// Checks a fixed length, writes a free one.
  Status length(const Field& field, std::size_t size) {
    if (field.length && *field.length != size) {
      return refuse(Errc::bad_value,
                    std::to_string(size) + " values, where " + std::to_string(*field.length) + " are needed");
    }
    if (!field.length) put_little(out_, static_cast<std::uint32_t>(size));
    return Done{};
  }

  Status zeros(const Field& field) {
    if (!field.length) put_little(out_, std::uint32_t{0});
    for (std::uint32_t i = 0; i < field.length.value_or(0); ++i) {
      if (auto put = one(field, nullptr); !put) return put;
      if (out_.size() > kMaxMessage) return refuse(Errc::too_large, "the message is over 1 MiB");
    }
    return Done{};
  }

  Status one(const Field& field, const Value* json) {
    static const Value kNothing{Value::Object{}};
    if (field.message) return message(*field.message, json == nullptr ? kNothing : *json);
    if (json != nullptr) return primitive(field.primitive, *json);
    switch (field.primitive) {
      case Primitive::boolean:
        return primitive(field.primitive, Value{false});
      case Primitive::string:
        return primitive(field.primitive, Value{std::string()});
      case Primitive::time:
      case Primitive::duration:
        return primitive(field.primitive, kNothing);
      default:
        return primitive(field.primitive, Value{std::int64_t{0}});
    }
  }

  Result<Bytes> from_base64(const std::string& text) {
    Bytes decoded(text.size(), '\0');
    std::size_t size = 0;
    const char* end = nullptr;
    if (sodium_base642bin(reinterpret_cast<unsigned char*>(decoded.data()), decoded.size(), text.data(), text.size(),
                          nullptr, &size, &end, sodium_base64_VARIANT_ORIGINAL) != 0 ||
        end != text.data() + text.size()) {
      return refuse(Errc::bad_value, "text that is no base64", "give the bytes as base64, or as a list of numbers");
    }
    decoded.resize(size);
    return decoded;
  }

  Status bytes(const Field& field, const std::string& text) {
    const auto decoded = from_base64(text);
    if (!decoded) return decoded.error();
    if (auto fits = length(field, decoded->size()); !fits) return fits;
    out_ += *decoded;
    return Done{};
  }

  Status text(const Value& json) {
    if (json.is_text()) return put_text(json.text());
    const Value* base64 = json.find("base64");
    if (base64 == nullptr || !base64->is_text() || json.object().size() != 1) return wrong(json, "text");
    const auto decoded = from_base64(base64->text());
    return decoded ? put_text(*decoded) : decoded.error();
  }
  Status put_text(BytesView text) {
    put_little(out_, static_cast<std::uint32_t>(text.size()));
    out_ += text;
    return Done{};
  }

  Status primitive(Primitive primitive, const Value& json) {
    switch (primitive) {
      case Primitive::boolean: {
        const bool number = json.is_integer() && (json.integer() == 0 || json.integer() == 1);
        if (!json.is_bool() && !number) return wrong(json, "true or false");
        out_.push_back(static_cast<char>(number ? json.integer() : json.boolean()));
        return Done{};
      }
      case Primitive::int8:
        return integer<std::int8_t>(json);
      case Primitive::uint8:
        return integer<std::uint8_t>(json);
      case Primitive::int16:
        return integer<std::int16_t>(json);
      case Primitive::uint16:
        return integer<std::uint16_t>(json);
      case Primitive::int32:
        return integer<std::int32_t>(json);
      case Primitive::uint32:
        return integer<std::uint32_t>(json);
      case Primitive::int64:
        return integer<std::int64_t>(json);
      case Primitive::uint64:
        return integer<std::uint64_t>(json);
      case Primitive::float32:
        return real<float, std::uint32_t>(json);
      case Primitive::float64:
        return real<double, std::uint64_t>(json);
      case Primitive::string:
        return text(json);
      case Primitive::time:
        return time<std::uint32_t>(json);
      case Primitive::duration:
        return time<std::int32_t>(json);
      default:
        return refuse(Errc::bad_value, "no primitive");
    }
  }

  template <class T>
  Status integer(const Value& json) {
    const std::string range = "a whole number from " + std::to_string(std::numeric_limits<T>::min()) + " to " +
                              std::to_string(std::numeric_limits<T>::max());
    T number{};
    if (json.is_integer()) {
      if (!std::in_range<T>(json.integer()))
        return refuse(Errc::bad_value, std::to_string(json.integer()) + " is not " + range);
      number = static_cast<T>(json.integer());
    } else if (json.is_number()) {
      // 2^63 is the first double beyond both; a double has no fraction there.
      const double real = json.number();
      if (std::trunc(real) != real || real < -9.2e18 || real > 9.2e18 ||
          !std::in_range<T>(static_cast<std::int64_t>(real))) {
        return refuse(Errc::bad_value, "not " + range, sizeof(T) == 8 ? "write a large one as text" : "");
      }
      number = static_cast<T>(static_cast<std::int64_t>(real));
    } else if (sizeof(T) == 8 && json.is_text()) {
      const auto written = parse_number<T>(json.text());
      if (!written) return refuse(Errc::bad_value, "text that is not " + range);
      number = *written;
    } else {
      return wrong(json, range);
    }
    put_little(out_, static_cast<std::make_unsigned_t<T>>(number));
    return Done{};
  }

  template <class T, class Bits>
  Status real(const Value& json) {
    T number{};
    if (json.is_number()) {
      number = static_cast<T>(json.number());
      if (!std::isfinite(number)) return refuse(Errc::bad_value, "a number that is too large for its type");
    } else if (is_no_number(json)) {
      return refuse(Errc::bad_value, "'" + json.text() + "' is no number that a robot can follow",
                    "send a finite number, or leave the field out: it is then 0");
    } else {
      return wrong(json, "a number");
    }
    put_little(out_, std::bit_cast<Bits>(number));
    return Done{};
  }

  template <class Seconds>
  Status time(const Value& json) {
    if (!json.is_object()) return wrong(json, R"({"secs", "nsecs"})");
    static const Value kZero{std::int64_t{0}};
    const Value* secs = json.find("secs");
    const Value* nsecs = json.find("nsecs");
    if (json.object().size() != static_cast<std::size_t>((secs != nullptr) + (nsecs != nullptr))) {
      return refuse(Errc::unknown_key, "has other keys than secs and nsecs");
    }
    path_ += ".secs";
    if (auto put = integer<Seconds>(secs == nullptr ? kZero : *secs); !put) return put;
    path_.replace(path_.size() - 4, 4, "nsecs");
    if (auto put = integer<Seconds>(nsecs == nullptr ? kZero : *nsecs); !put) return put;
    path_.resize(path_.size() - 6);
    return Done{};
  }

  Bytes out_;
  std::string path_;
};

}  // namespace

Result<Bytes> to_wire(const RosType& type, const Value& json) {
  Writer writer;
  Status put{Done{}};
  if (json.is_object()) {
    put = writer.message(type, json);
  } else {
    if (!type.values) {
      return fail(Errc::bad_value, type.name + ": has a part of free length, a list of values does not tell how long",
                  "write an object");
    }
    const bool alone = !json.is_list();
    std::span<const Value> values = alone ? std::span(&json, 1) : std::span(json.list());
    if (values.size() != *type.values) {
      return fail(Errc::bad_value,
                  type.name + ": " + std::to_string(values.size()) + " values, where " + std::to_string(*type.values) +
                      " are needed",
                  "give every value in the order of the fields, or write an object");
    }
    put = writer.flat(type, values);
  }
  if (!put) return put.error();
  if (writer.size() > kMaxMessage) return fail(Errc::too_large, type.name + ": the message is over 1 MiB");
  return writer.take();
}

}  // namespace trb::ros
