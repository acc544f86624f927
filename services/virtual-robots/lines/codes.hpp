#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace trb::virtual_robots::lines {

/** The numbers of words in the numeric encoding, separate for subtypes and for ids. */
class Codes {
 public:
  /** Takes `subtype:WORD=NUMBER` or `id:WORD=NUMBER`; false if it is neither. */
  bool add(std::string_view definition);

  /** The number of a word; a word that is a number already stays as it is. */
  std::optional<std::string> subtype_number(const std::string& word) const { return number_of(subtypes_, word); }
  std::optional<std::string> id_number(const std::string& word) const { return number_of(ids_, word); }

  /** The word of a number, or the number if it has no word. */
  std::string subtype_word(const std::string& number) const { return word_of(subtypes_, number); }
  std::string id_word(const std::string& number) const { return word_of(ids_, number); }

 private:
  using Table = std::map<std::string, std::string>;

  static std::optional<std::string> number_of(const Table& table, const std::string& word);
  static std::string word_of(const Table& table, const std::string& number);

  Table subtypes_;
  Table ids_;
};

}  // namespace trb::virtual_robots::lines
