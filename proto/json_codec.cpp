// The JSON codec of every body (see body.hpp), and of the message itself.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "common/base/hex.hpp"
#include "common/base/ids.hpp"
#include "proto/body.hpp"
#include "proto/field_reader.hpp"
#include "proto/make_shape.hpp"
#include "proto/message.hpp"
#include "proto/value.hpp"

namespace trb {
namespace {

// ---- writing

Value text_of(std::string_view text) {
  return Value{std::string(text)};
}

Value json_of_unsigned(std::uint64_t value) {
  // A JSON reader may round beyond 2^53: such numbers are identifiers and go as text.
  return value > (1ULL << 53U) ? Value{std::to_string(value)} : Value{static_cast<std::int64_t>(value)};
}

Value json_of_enum(std::span<const std::string_view> names, std::uint64_t index) {
  return text_of(index < names.size() ? names[index] : std::string_view("?"));
}

Value json_of(const Shape& shape, const void* value);

Value json_of_list(const ListShape& shape, const void* value) {
  Value::List out;
  const std::size_t size = shape.size(value);
  const void* at = shape.data(value);
  for (std::size_t i = 0; i < size; ++i, at = behind(at, shape.stride)) out.push_back(json_of(*shape.item, at));
  return Value{std::move(out)};
}

Value json_of_fields(std::span<const FieldEntry> fields, const void* value) {
  Value::Object out;
  for (const FieldEntry& f : fields) out.emplace_back(std::string(f.name), json_of(*f.shape, behind(value, f.offset)));
  return Value{std::move(out)};
}

Value json_of(const Shape& shape, const void* value) {
  switch (shape.kind) {
    case FieldKind::boolean:
      return Value{as<bool>(value)};
    case FieldKind::enumeration:
      return json_of_enum(shape.names, unsigned_of(shape.kind, value));
    case FieldKind::uint16:
    case FieldKind::uint32:
    case FieldKind::uint64:
      return json_of_unsigned(unsigned_of(shape.kind, value));
    case FieldKind::int64:
      return Value{as<std::int64_t>(value)};
    case FieldKind::number:
      return Value{as<double>(value)};
    case FieldKind::text:
      return Value{as<std::string>(value)};
    case FieldKind::blob:
      return Value{to_hex(as<Blob>(value).bytes)};
    case FieldKind::list:
      return json_of_list(shape.list, value);
    case FieldKind::record:
      break;
  }
  return json_of_fields(shape.fields, value);
}

// ---- reading: returns false and sets `error`

struct JsonReader : FieldReader<JsonReader, Value> {
  bool needs(std::string_view what, const Value& from) {
    return refuse(Errc::malformed, "needs " + std::string(what) + ", got " + std::string(from.kind()));
  }

  template <class T>
  bool take_integer(const Value& from, T& out);
  bool take_integer(const Value& from, std::uint64_t& out);
  bool take_enum(std::span<const std::string_view> names, const Value& from, std::uint8_t& out);
  bool take_list(const ListShape& shape, const Value& from, void* out, std::uint32_t max);
  bool take_fields(std::span<const FieldEntry> fields, const Value& from, void* out);
  bool take_bool(const Value& from, bool& out);
  bool take_double(const Value& from, double& out);
  bool take_text(const Value& from, std::string& out, std::uint32_t max);
  bool take_blob(const Value& from, Blob& out, std::uint32_t max);
};

template <class T>
bool JsonReader::take_integer(const Value& from, T& out) {
  if (!from.is_integer()) return needs("a whole number", from);
  const std::int64_t raw = from.integer();
  if (!std::in_range<T>(raw)) return refuse(Errc::bad_value, std::to_string(raw) + " is out of range");
  out = static_cast<T>(raw);
  return true;
}

bool JsonReader::take_integer(const Value& from, std::uint64_t& out) {
  if (!from.is_text()) return take_integer<std::uint64_t>(from, out);
  const std::string& text = from.text();
  const char* const end = text.data() + text.size();
  const auto [stop, problem] = std::from_chars(text.data(), end, out);
  if (stop != end || problem == std::errc::invalid_argument) return refuse(Errc::malformed, "no whole number");
  return problem == std::errc{} || refuse(Errc::bad_value, text + " is out of range");
}

bool JsonReader::take_enum(std::span<const std::string_view> names, const Value& from, std::uint8_t& out) {
  for (std::size_t i = 0; from.is_text() && i < names.size(); ++i) {
    if (from.text() != names[i]) continue;
    out = static_cast<std::uint8_t>(i);
    return true;
  }
  std::string all;
  for (const std::string_view name : names) all += (all.empty() ? "" : ", ") + std::string(name);
  return refuse(Errc::bad_value, "is not one of " + all);
}

bool JsonReader::take_bool(const Value& from, bool& out) {
  if (!from.is_bool()) return needs("true or false", from);
  out = from.boolean();
  return true;
}

bool JsonReader::take_double(const Value& from, double& out) {
  if (!from.is_number()) return needs("a number", from);
  out = from.number();
  return std::isfinite(out) || refuse(Errc::bad_value, "not a finite number");
}

bool JsonReader::take_text(const Value& from, std::string& out, std::uint32_t max) {
  if (!from.is_text()) return needs("text", from);
  if (from.text().size() > max) return refuse(Errc::too_large, "text over " + std::to_string(max) + " bytes");
  out = from.text();
  return true;
}

bool JsonReader::take_blob(const Value& from, Blob& out, std::uint32_t max) {
  if (!from.is_text()) return needs("hexadecimal text", from);
  auto bytes = from_hex(from.text());
  if (!bytes) return refuse(Errc::malformed, bytes.error().what);
  if (bytes->size() > max) return refuse(Errc::too_large, "over " + std::to_string(max) + " bytes");
  out.bytes = std::move(*bytes);
  return true;
}

bool JsonReader::take_list(const ListShape& shape, const Value& from, void* out, std::uint32_t max) {
  if (!from.is_list()) return needs("a list", from);
  if (from.list().size() > max) return refuse(Errc::too_large, "list over " + std::to_string(max) + " items");
  void* at = shape.renew(out, from.list().size());
  const std::size_t stem = path.size();
  std::size_t index = 0;
  for (const Value& item : from.list()) {
    path += "[" + std::to_string(index++) + "]";
    if (!take(*shape.item, item, at, kDefaultMaxSize)) return false;
    path.resize(stem);
    at = behind(at, shape.stride);
  }
  return true;
}

bool JsonReader::take_fields(std::span<const FieldEntry> fields, const Value& from, void* out) {
  if (!from.is_object()) return needs("an object", from);
  const std::size_t stem = path.size();
  for (const auto& [key, member] : from.object()) {
    path += (stem > 0 ? "." : "") + key;
    const auto is_named = [&key = key](const FieldEntry& f) { return f.name == key; };
    const auto f = std::find_if(fields.begin(), fields.end(), is_named);
    if (f == fields.end()) return refuse(Errc::unknown_key, "no such field");
    if (!take(*f->shape, member, behind(out, f->offset), f->max)) return false;
    path.resize(stem);
  }
  return true;
}

Error read(const Shape& shape, const Value& from, void* out) {
  JsonReader reader;
  reader.take(shape, from, out, kDefaultMaxSize);
  return std::move(reader.error);
}

/// The message in its JSON form; `size` is checked against the data.
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
  static FieldTable fields() {
    return FieldTable{field("type", &T::type),
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

}  // namespace

std::string write_json(const Shape& shape, const void* value) {
  return dump_json(json_of(shape, value));
}

Error read_json(const Shape& shape, std::string_view json, void* value) {
  const auto parsed = parse_json(json);
  if (!parsed) return parsed.error();
  return read(shape, *parsed, value);
}

std::string message_to_json(const Message& message) {
  Value::Object out;
  const auto add = [&out](std::string_view key, Value value) { out.emplace_back(std::string(key), std::move(value)); };
  add("type", text_of(name_of(message.type)));
  add("subtype", text_of(message.subtype));
  add("source", text_of(message.source));
  add("target", text_of(message.target));
  add("id", json_of_unsigned(message.id));
  if (message.reply_to != 0) add("reply_to", json_of_unsigned(message.reply_to));
  add("size", json_of_unsigned(message.data.size()));
  const auto body = is_typed(message.subtype) ? body_to_json(message.subtype, message.data)
                                              : Result<std::string>(fail(Errc::bad_value, "opaque"));
  auto shown = body ? parse_json(*body) : Result<Value>(body.error());
  if (shown) {
    add("body", std::move(*shown));
  } else if (is_utf8(message.data)) {
    add("data", text_of(message.data));
  } else {
    add("data_hex", Value{to_hex(message.data)});
  }
  return dump_json(Value{std::move(out)});
}

namespace {

/// Removes the member with that key from an object and returns it.
std::optional<Value> take_member(Value& from, std::string_view key) {
  auto* members = std::get_if<Value::Object>(&from.is);
  if (members == nullptr) return std::nullopt;
  const auto at = std::find_if(members->begin(), members->end(), [&](const auto& m) { return m.first == key; });
  if (at == members->end()) return std::nullopt;
  Value out = std::move(at->second);
  members->erase(at);
  return out;
}

/// The data, given as text, as hexadecimal or as a typed body; at most one of them.
Result<Bytes> data_of(MessageForm& form, const std::optional<Value>& body, bool sized) {
  if (body) {
    if (!form.data.empty() || !form.data_hex.bytes.empty()) {
      return fail(Errc::bad_value, "body: comes with data", "keep one");
    }
    auto bytes = body_from_json(form.subtype, dump_json(*body));
    if (!bytes) return fail(bytes.error().code, "body: " + bytes.error().what, bytes.error().hint);
    return bytes;  // its size is that of the msgpack, which the JSON's author need not know
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
  MessageForm form;
  if (Error error = read(make_shape<MessageForm>(), *value, &form); error.code != Errc::ok) return error;
  if (form.type == MessageType::none) return fail(Errc::missing, "type: missing or none");
  if (form.subtype.empty()) return fail(Errc::missing, "subtype: missing");
  if (!is_valid_word(form.subtype)) return fail(Errc::bad_value, "subtype: '" + form.subtype + "' is no word");
  auto data = data_of(form, body, value->find("size") != nullptr);
  if (!data) return data.error();
  Message message;
  message.type = form.type;
  message.subtype = std::move(form.subtype);
  message.source = std::move(form.source);
  message.target = std::move(form.target);
  message.id = form.id;
  message.reply_to = form.reply_to;
  message.data = std::move(*data);
  return message;
}

}  // namespace trb
