#include "services/ros-bridge/core/message_type.hpp"

#include <md5.h>

#include <algorithm>

namespace trb::ros {
namespace {

const std::string kBorder = std::string(80, '=') + "\n";
constexpr std::size_t kMaxDepth = 32;
constexpr std::size_t kMaxTypes = 2000;
constexpr std::size_t kMaxValues = 1U << 20U;

std::string md5_of(std::string_view text) {
  MD5_CTX state;
  MD5Init(&state);
  MD5Update(&state, reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  std::string hex(MD5_DIGEST_STRING_LENGTH, '\0');
  MD5End(&state, hex.data());
  hex.pop_back();
  return hex;
}

std::string type_as_written(const FieldText& field) {
  if (!field.array) return field.type;
  return field.type + "[" + (field.length ? std::to_string(*field.length) : "") + "]";
}

/// Constants first, then the fields; a message stands with its own sum in its type's place.
std::string md5_text(const MessageText& text, const std::vector<Field>& fields) {
  std::string out;
  for (const ConstantText& constant : text.constants) {
    out += constant.type + " " + constant.name + "=" + constant.value + "\n";
  }
  for (std::size_t i = 0; i < fields.size(); ++i) {
    out += (fields[i].message ? fields[i].message->md5 : type_as_written(text.fields[i])) + " " + fields[i].name + "\n";
  }
  if (!out.empty()) out.pop_back();
  return out;
}

std::size_t size_of(Primitive primitive) {
  switch (primitive) {
    case Primitive::boolean:
    case Primitive::int8:
    case Primitive::uint8:
      return 1;
    case Primitive::int16:
    case Primitive::uint16:
      return 2;
    case Primitive::int64:
    case Primitive::uint64:
    case Primitive::float64:
    case Primitive::time:
    case Primitive::duration:
      return 8;
    default:
      return 4;
  }
}

Status add_up(RosType& type) {
  type.values = 0;
  for (const Field& field : type.fields) {
    const bool timed = field.primitive == Primitive::time || field.primitive == Primitive::duration;
    const std::size_t one_size = field.message ? field.message->least_size : size_of(field.primitive);
    const std::optional<std::size_t> one =
        field.message ? field.message->values : std::optional<std::size_t>(timed ? 2 : 1);
    const bool is_free = field.array && !field.length;
    const std::size_t times = field.length.value_or(1);
    type.least_size += is_free ? 4 : times * one_size;
    if (is_free || !one) {
      type.values.reset();
    } else if (type.values) {
      *type.values += times * *one;
    }
    if (type.least_size > kMaxValues * 8 || type.values.value_or(0) > kMaxValues) {
      return fail(Errc::too_large, type.name + ": more than a million values");
    }
  }
  return Done{};
}

/// The types that a type contains, by name.
void collect(const RosType& type, std::map<std::string, const RosType*>& parts) {
  for (const Field& field : type.fields) {
    if (field.message && parts.emplace(field.message->name, field.message.get()).second) collect(*field.message, parts);
  }
}

Error named(const std::string& type, const Error& error) {
  return fail(error.code, type + ": " + error.what, error.hint);
}

}  // namespace

Result<RosTypePtr> TypeStore::find(const std::string& type) {
  std::vector<std::string> inside;
  return build(type, inside);
}

Result<RosTypePtr> TypeStore::build(const std::string& type, std::vector<std::string>& inside) {
  if (const auto known = types_.find(type); known != types_.end()) return known->second;
  if (!is_type_name(type)) {
    return fail(Errc::bad_value, "'" + type.substr(0, 80) + "' is no message type", "write package/Name");
  }
  if (std::ranges::find(inside, type) != inside.end() || inside.size() >= kMaxDepth) {
    return fail(Errc::bad_value, type + ": contains itself or is nested deeper than " + std::to_string(kMaxDepth));
  }
  if (types_.size() >= kMaxTypes) return fail(Errc::too_large, type + ": over " + std::to_string(kMaxTypes) + " types");
  const auto text = read_(type);
  if (!text) return text.error();
  const auto parsed = parse_message_text(*text);
  if (!parsed) return named(type, parsed.error());
  inside.push_back(type);
  auto out = std::make_shared<RosType>();
  out->name = type;
  out->text = *text;
  if (Status good = add_fields(*out, parsed->fields, inside); !good) return good.error();
  inside.pop_back();
  if (auto added = add_up(*out); !added) return added.error();
  out->md5 = md5_of(md5_text(*parsed, out->fields));
  types_[type] = out;
  return RosTypePtr(out);
}

Status TypeStore::add_fields(RosType& type, const std::vector<FieldText>& fields, std::vector<std::string>& inside) {
  const std::string package = type.name.substr(0, type.name.find('/'));
  for (const FieldText& field : fields) {
    type.fields.push_back({field.name, field.primitive, field.array, field.length, nullptr});
    if (field.primitive != Primitive::none) continue;
    auto nested = build(full_type_name(package, field.type), inside);
    if (!nested) return named(type.name + "." + field.name, nested.error());
    type.fields.back().message = *nested;
  }
  return Done{};
}

std::string full_definition(const RosType& type) {
  std::map<std::string, const RosType*> parts;
  collect(type, parts);
  std::string out = type.text;
  for (const auto& [name, part] : parts) out += "\n" + kBorder + "MSG: " + name + "\n" + part->text;
  return out;
}

Result<RosTypePtr> type_from_full_definition(const std::string& type, std::string_view definition) {
  std::map<std::string, std::string> texts;
  for (std::string name = type;;) {
    const std::size_t end = definition.find("\n" + kBorder);
    texts.emplace(name, definition.substr(0, end));
    if (end == std::string_view::npos) break;
    definition.remove_prefix(end + 1 + kBorder.size());
    const std::size_t line = std::min(definition.find('\n'), definition.size());
    constexpr std::string_view kMark = "MSG: ";
    if (!definition.starts_with(kMark)) {
      return fail(Errc::malformed, type + ": no 'MSG: type' behind a border in the connection's definition");
    }
    name = definition.substr(kMark.size(), line - kMark.size());
    definition.remove_prefix(std::min(line + 1, definition.size()));
  }
  TypeStore store([&](const std::string& name) -> Result<std::string> {
    const auto at = texts.find(name);
    if (at == texts.end()) return fail(Errc::missing, name + ": not in the connection's definition");
    return at->second;
  });
  return store.find(type);
}

}  // namespace trb::ros
