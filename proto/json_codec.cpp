// The JSON codec of every body (see body.hpp), and of the message itself.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/hex.hpp"
#include "common/base/ids.hpp"
#include "proto/body.hpp"
#include "proto/message.hpp"
#include "proto/value.hpp"

namespace trb {
namespace {

// ---- writing

template <class T>
Value put(const T& value) {
  if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, std::string>) {
    return Value{value};
  } else if constexpr (std::is_enum_v<T>) {
    return Value{std::string(name_of(value))};
  } else if constexpr (std::is_floating_point_v<T>) {
    return Value{static_cast<double>(value)};
  } else if constexpr (std::is_same_v<T, std::uint64_t>) {
    // Beyond 2^53 a JSON reader may round: such numbers are identifiers, and go as text.
    return value > (1ULL << 53U) ? Value{std::to_string(value)} : Value{static_cast<std::int64_t>(value)};
  } else if constexpr (std::is_integral_v<T>) {
    return Value{static_cast<std::int64_t>(value)};
  } else if constexpr (std::is_same_v<T, Blob>) {
    return Value{to_hex(value.bytes)};
  } else if constexpr (IsVector<T>::value) {
    Value::List out;
    for (const auto& item : value) out.push_back(put(item));
    return Value{std::move(out)};
  } else {
    Value::Object out;
    std::apply([&](const auto&... f) { (out.emplace_back(std::string(f.name), put(value.*(f.member))), ...); },
               T::fields());
    return Value{std::move(out)};
  }
}

// ---- reading

struct Reader {
  std::string path;
  Error error;

  bool refuse(Errc code, std::string_view what) {
    if (error.code == Errc::ok)
      error = fail(code, (path.empty() ? std::string("body") : path) + ": " + std::string(what));
    return false;
  }

  template <class T>
  bool take(const Value& from, T& out, std::uint32_t max);

 private:
  template <class T>
  bool take_integer(const Value& from, T& out);
  template <class T>
  bool take_enum(const Value& from, T& out);
  template <class T>
  bool take_list(const Value& from, std::vector<T>& out, std::uint32_t max);
  template <class T>
  bool take_fields(const Value& from, T& out);
  bool take_double(const Value& from, double& out);
  bool take_text(const Value& from, std::string& out, std::uint32_t max);
  bool take_blob(const Value& from, Blob& out, std::uint32_t max);
};

template <class T>
bool Reader::take_integer(const Value& from, T& out) {
  if constexpr (std::is_same_v<T, std::uint64_t>) {
    if (from.is_text()) {
      const std::string& text = from.text();
      const char* const end = text.data() + text.size();
      const auto [stop, problem] = std::from_chars(text.data(), end, out);
      if (stop != end || problem == std::errc::invalid_argument) return refuse(Errc::malformed, "no whole number");
      return problem == std::errc{} || refuse(Errc::bad_value, text + " is out of range");
    }
  }
  if (!from.is_integer()) return refuse(Errc::malformed, "needs a whole number, got " + std::string(from.kind()));
  const std::int64_t raw = from.integer();
  if (!std::in_range<T>(raw)) return refuse(Errc::bad_value, std::to_string(raw) + " is out of range");
  out = static_cast<T>(raw);
  return true;
}

template <class T>
bool Reader::take_enum(const Value& from, T& out) {
  constexpr auto names = enum_names(T{});
  for (std::size_t i = 0; from.is_text() && i < names.size(); ++i) {
    if (from.text() != names[i]) continue;
    out = static_cast<T>(i);
    return true;
  }
  std::string all;
  for (const std::string_view name : names) all += (all.empty() ? "" : ", ") + std::string(name);
  return refuse(Errc::bad_value, "is none of " + all);
}

bool Reader::take_double(const Value& from, double& out) {
  if (!from.is_number()) return refuse(Errc::malformed, "needs a number, got " + std::string(from.kind()));
  out = from.number();
  return std::isfinite(out) || refuse(Errc::bad_value, "not a finite number");
}

bool Reader::take_text(const Value& from, std::string& out, std::uint32_t max) {
  if (!from.is_text()) return refuse(Errc::malformed, "needs text, got " + std::string(from.kind()));
  if (from.text().size() > max) return refuse(Errc::too_large, "text over " + std::to_string(max) + " bytes");
  out = from.text();
  return true;
}

bool Reader::take_blob(const Value& from, Blob& out, std::uint32_t max) {
  if (!from.is_text()) return refuse(Errc::malformed, "needs hexadecimal text, got " + std::string(from.kind()));
  auto bytes = from_hex(from.text());
  if (!bytes) return refuse(Errc::malformed, bytes.error().what);
  if (bytes->size() > max) return refuse(Errc::too_large, "over " + std::to_string(max) + " bytes");
  out.bytes = std::move(*bytes);
  return true;
}

template <class T>
bool Reader::take_list(const Value& from, std::vector<T>& out, std::uint32_t max) {
  if (!from.is_list()) return refuse(Errc::malformed, "needs a list, got " + std::string(from.kind()));
  if (from.list().size() > max) return refuse(Errc::too_large, "list over " + std::to_string(max) + " items");
  out.clear();
  const std::size_t stem = path.size();
  for (const Value& item : from.list()) {
    path += "[" + std::to_string(out.size()) + "]";
    if (!take(item, out.emplace_back(), kDefaultMaxSize)) return false;
    path.resize(stem);
  }
  return true;
}

template <class T>
bool Reader::take_fields(const Value& from, T& out) {
  if (!from.is_object()) return refuse(Errc::malformed, "needs an object, got " + std::string(from.kind()));
  const std::size_t stem = path.size();
  for (const auto& [key, member] : from.object()) {
    bool known = false;
    bool good = true;
    const auto one = [&](const auto& f) {
      if (f.name != key) return;
      known = true;
      good = take(member, out.*(f.member), f.max);
    };
    path += (stem > 0 ? "." : "") + key;
    std::apply([&](const auto&... f) { (one(f), ...); }, T::fields());
    if (!known) return refuse(Errc::unknown_key, "no such field");
    if (!good) return false;
    path.resize(stem);
  }
  return true;
}

template <class T>
bool Reader::take(const Value& from, T& out, std::uint32_t max) {
  if constexpr (std::is_same_v<T, bool>) {
    if (!from.is_bool()) return refuse(Errc::malformed, "needs true or false, got " + std::string(from.kind()));
    out = from.boolean();
    return true;
  } else if constexpr (std::is_enum_v<T>) {
    return take_enum(from, out);
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

/// The message as JSON reads it; `size` is checked against the data.
struct MessageForm {
  MessageType type = MessageType::none;
  std::string subtype;
  std::string source;
  std::string target;
  std::uint64_t id = 0;
  std::uint64_t reply_to = 0;
  std::uint32_t size = 0;
  std::string data;
  Blob data_hex;
  template <class T = MessageForm>
  static constexpr auto fields() {
    return std::tuple{field("type", &T::type),
                      field("subtype", &T::subtype, 64),
                      field("source", &T::source, 64),
                      field("target", &T::target, 64),
                      field("id", &T::id),
                      field("reply_to", &T::reply_to),
                      field("size", &T::size),
                      field("data", &T::data, kMaxDataSize),
                      field("data_hex", &T::data_hex, kMaxDataSize)};
  }
};

template <class T>
Result<T> read(const Value& value) {
  Reader reader;
  T out{};
  if (!reader.take(value, out, kDefaultMaxSize)) return reader.error;
  return out;
}

}  // namespace

template <class T>
std::string to_json(const T& body) {
  return dump_json(put(body));
}

template <class T>
Result<T> from_json(std::string_view json) {
  auto value = parse_json(json);
  if (!value) return value.error();
  return read<T>(*value);
}

#define TRB_INSTANTIATE(Name)                \
  template std::string to_json(const Name&); \
  template Result<Name> from_json(std::string_view);
TRB_BODIES(TRB_INSTANTIATE)
#undef TRB_INSTANTIATE

std::string message_to_json(const Message& message) {
  Value::Object out;
  const auto add = [&out](std::string_view key, Value value) { out.emplace_back(std::string(key), std::move(value)); };
  add("type", put(message.type));
  add("subtype", put(message.subtype));
  add("source", put(message.source));
  add("target", put(message.target));
  add("id", put(message.id));
  if (message.reply_to != 0) add("reply_to", put(message.reply_to));
  add("size", put(static_cast<std::uint64_t>(message.data.size())));
  const auto body = is_typed(message.subtype) ? body_to_json(message.subtype, message.data)
                                              : Result<std::string>(fail(Errc::bad_value, "opaque"));
  if (body) {
    add("body", *parse_json(*body, {.bytes = SIZE_MAX}));
  } else if (is_utf8(message.data)) {
    add("data", put(message.data));
  } else {
    add("data_hex", Value{to_hex(message.data)});
  }
  return dump_json(Value{std::move(out)});
}

namespace {

/// Takes the member of that key out of an object.
std::optional<Value> take_member(Value& from, std::string_view key) {
  auto* members = std::get_if<Value::Object>(&from.is);
  if (members == nullptr) return std::nullopt;
  const auto at = std::find_if(members->begin(), members->end(), [&](const auto& m) { return m.first == key; });
  if (at == members->end()) return std::nullopt;
  Value out = std::move(at->second);
  members->erase(at);
  return out;
}

/// Data as text, as hexadecimal or as a typed body: one of them.
Result<Bytes> data_of(MessageForm& form, const std::optional<Value>& body, bool sized) {
  if (body) {
    if (!form.data.empty() || !form.data_hex.bytes.empty()) {
      return fail(Errc::bad_value, "body: comes with data", "keep one");
    }
    auto bytes = body_from_json(form.subtype, dump_json(*body));
    if (!bytes) return fail(bytes.error().code, "body: " + bytes.error().what, bytes.error().cure);
    return bytes;  // its size is msgpack's, which a writer of JSON need not know
  }
  if (!form.data.empty() && !form.data_hex.bytes.empty()) {
    return fail(Errc::bad_value, "data_hex: comes with data", "keep one");
  }
  Bytes bytes = form.data_hex.bytes.empty() ? std::move(form.data) : std::move(form.data_hex.bytes);
  if (sized && form.size != bytes.size()) {
    return fail(Errc::bad_value,
                "size: " + std::to_string(form.size) + ", but the data has " + std::to_string(bytes.size()) + " bytes");
  }
  return bytes;
}

}  // namespace

Result<Message> message_from_json(std::string_view json) {
  auto value = parse_json(json, {.bytes = 4 * kMaxDataSize});
  if (!value) return value.error();
  const std::optional<Value> body = take_member(*value, "body");
  auto form = read<MessageForm>(*value);
  if (!form) return form.error();
  if (form->type == MessageType::none) return fail(Errc::missing, "type: missing or none");
  if (form->subtype.empty()) return fail(Errc::missing, "subtype: missing");
  if (!is_valid_word(form->subtype)) return fail(Errc::bad_value, "subtype: '" + form->subtype + "' is no word");
  auto data = data_of(*form, body, value->find("size") != nullptr);
  if (!data) return data.error();
  Message message;
  message.type = form->type;
  message.subtype = std::move(form->subtype);
  message.source = std::move(form->source);
  message.target = std::move(form->target);
  message.id = form->id;
  message.reply_to = form->reply_to;
  message.data = std::move(*data);
  return message;
}

}  // namespace trb
