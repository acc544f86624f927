#include "services/virtual-robots/lines/codes.hpp"

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::lines {

bool Codes::add(std::string_view definition) {
  const std::size_t colon = definition.find(':');
  const std::size_t equals = definition.rfind('=');
  if (colon == std::string_view::npos || equals == std::string_view::npos || equals <= colon + 1) return false;
  const std::string_view table = definition.substr(0, colon);
  const std::string word(definition.substr(colon + 1, equals - colon - 1));
  const auto number = parse_integer(definition.substr(equals + 1));
  if (!number || (table != "subtype" && table != "id")) return false;
  (table == "subtype" ? subtypes_ : ids_)[word] = std::to_string(*number);
  return true;
}

std::optional<std::string> Codes::number_of(const Table& table, const std::string& word) {
  const auto found = table.find(word);
  if (found != table.end()) return found->second;
  if (parse_integer(word)) return word;
  return std::nullopt;
}

std::string Codes::word_of(const Table& table, const std::string& number) {
  for (const auto& [word, its_number] : table) {
    if (its_number == number) return word;
  }
  return number;
}

}  // namespace trb::virtual_robots::lines
