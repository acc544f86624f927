#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "services/virtual-robots/lines/codes.hpp"
#include "services/virtual-robots/lines/message.hpp"

namespace trb::virtual_robots::lines {

/** The words of the channel in one of its two encodings. */
struct Vocabulary {
  bool numeric = false;
  Codes codes;

  std::string_view ok() const { return numeric ? "0" : "ok"; }
  std::string_view stop() const { return numeric ? "-1" : "!stop"; }
  std::string_view release() const { return numeric ? "-2" : "!release"; }
  std::string_view stopped() const { return numeric ? "-1" : "!stopped"; }
  std::string_view released() const { return numeric ? "-2" : "!released"; }

  /** The word for a type field; nothing if it is not a type. */
  std::optional<std::string> type_word(const std::string& field) const;

  /** Type, subtype, target and size of a message. A word without a number is returned instead, as KIND:WORD. */
  std::variant<std::vector<std::string>, std::string> head_of(const Message& message) const;
};

}  // namespace trb::virtual_robots::lines
