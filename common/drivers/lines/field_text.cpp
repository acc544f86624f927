#include "common/drivers/lines/field_text.hpp"

#include <charconv>
#include <cmath>

#include "common/base/ids.hpp"

namespace trb::drivers {
namespace {

constexpr std::array<MessageType, 3> kTypes = {MessageType::command, MessageType::request, MessageType::information};
constexpr std::string_view kOwnNode = "0";

std::optional<double> read_number(std::string_view text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) return std::nullopt;
  return number;
}

Error no_code(std::string_view list, std::string_view word) {
  return fail(Errc::unknown_subtype, "the robot speaks in numbers and has none for '" + std::string(word) + "'",
              "add it to field_channel.codes." + std::string(list) + " of the robot's description");
}

template <class Map>
std::optional<std::string> find(const Map& map, std::string_view key) {
  const auto found = map.find(key);
  return found == map.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace

FieldText::FieldText(const FieldChannel& settings, std::string own_id)
    : numeric_(settings.encoding == Encoding::numeric), own_id_(std::move(own_id)) {
  for (const auto& [word, code] : settings.subtype_codes) {
    subtype_codes_[word] = std::to_string(code);
    subtypes_[std::to_string(code)] = word;
  }
  for (const auto& [id, code] : settings.id_codes) {
    id_codes_[id] = std::to_string(code);
    ids_[std::to_string(code)] = id;
  }
}

Result<FieldHead> FieldText::head(MessageType type, std::string_view subtype, std::string_view source,
                                  BytesView data) const {
  if (numeric_) return numeric_head(type, subtype, source, data);
  return FieldHead{std::string(name_of(type)), std::string(subtype), std::string(source), std::to_string(data.size())};
}

Result<FieldHead> FieldText::numeric_head(MessageType type, std::string_view subtype, std::string_view source,
                                          BytesView data) const {
  const auto subtype_code = find(subtype_codes_, subtype);
  if (!subtype_code) return no_code("subtypes", subtype);
  auto source_code = find(id_codes_, source);
  if (!source_code && source == own_id_) source_code = kOwnNode;
  if (!source_code) return no_code("ids", source);
  if (!is_number_list(data)) {
    return fail(Errc::bad_value, "the robot speaks in numbers, and the data of '" + std::string(subtype) + "' is none",
                "give decimal numbers with one space between two");
  }
  return FieldHead{std::to_string(static_cast<int>(type)), *subtype_code, *source_code, std::to_string(data.size())};
}

std::optional<MessageType> FieldText::type_of(std::string_view field) const {
  for (const MessageType type : kTypes) {
    if (numeric_ ? field == std::to_string(static_cast<int>(type)) : field == name_of(type)) return type;
  }
  return std::nullopt;
}

std::optional<std::string> FieldText::subtype_of(std::string_view field) const {
  if (numeric_) return find(subtypes_, field);
  return is_valid_word(field) ? std::optional<std::string>(field) : std::nullopt;
}

std::optional<std::string> FieldText::target_of(std::string_view field) const {
  if (field.empty() || (numeric_ && field == kOwnNode)) return own_id_;
  if (numeric_) return find(ids_, field);
  return is_valid_id(field) ? std::optional<std::string>(field) : std::nullopt;
}

Bytes FieldText::unlike_orders(BytesView data) const {
  const bool alike = numeric_ && (data == order(Urgent::stop) || data == order(Urgent::release));
  return Bytes(data) + (alike ? ".0" : "");
}

std::string_view FieldText::order(Urgent urgent) const {
  if (urgent == Urgent::stop) return numeric_ ? "-1" : "!stop";
  return numeric_ ? "-2" : "!release";
}

std::optional<Urgent> FieldText::urgent_done(std::string_view field) const {
  if (field == (numeric_ ? "-1" : "!stopped")) return Urgent::stop;
  if (field == (numeric_ ? "-2" : "!released")) return Urgent::release;
  return std::nullopt;
}

bool is_number_list(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = text.find(' ');
    if (!read_number(text.substr(0, end))) return false;
    if (end == std::string_view::npos) return true;
    text.remove_prefix(end + 1);
    if (text.empty()) return false;
  }
  return true;
}

std::optional<std::vector<double>> read_numbers(std::string_view text) {
  constexpr std::string_view kBetween = " ,[]";
  std::vector<double> numbers;
  while (true) {
    const std::size_t begin = text.find_first_not_of(kBetween);
    if (begin == std::string_view::npos) return numbers;
    text.remove_prefix(begin);
    const std::size_t end = std::min(text.find_first_of(kBetween), text.size());
    const auto number = read_number(text.substr(0, end));
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    text.remove_prefix(end);
  }
}

}  // namespace trb::drivers
