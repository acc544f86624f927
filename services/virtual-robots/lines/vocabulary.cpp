#include "services/virtual-robots/lines/vocabulary.hpp"

#include <array>

namespace trb::virtual_robots::lines {
namespace {

/** A type's number is its place in this list, counted from 1. */
constexpr std::array<std::string_view, 3> kTypes = {"command", "request", "information"};

}  // namespace

std::optional<std::string> Vocabulary::type_word(const std::string& field) const {
  for (std::size_t i = 0; i < kTypes.size(); ++i) {
    if (field == (numeric ? std::to_string(i + 1) : kTypes[i])) return std::string(kTypes[i]);
  }
  return std::nullopt;
}

std::variant<std::vector<std::string>, std::string> Vocabulary::head_of(const Message& message) const {
  const std::string size = std::to_string(message.data.size());
  if (!numeric) return std::vector<std::string>{message.type, message.subtype, message.peer, size};
  std::size_t type = 0;
  while (type < kTypes.size() && kTypes[type] != message.type) ++type;
  const auto subtype = codes.subtype_number(message.subtype);
  const auto target = message.peer.empty() ? std::string("0") : codes.id_number(message.peer);
  if (type == kTypes.size()) return "type:" + message.type;
  if (!subtype) return "subtype:" + message.subtype;
  if (!target) return "id:" + message.peer;
  return std::vector<std::string>{std::to_string(type + 1), *subtype, *target, size};
}

}  // namespace trb::virtual_robots::lines
