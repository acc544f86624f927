#include "common/drivers/text/fault_text.hpp"

#include <algorithm>

namespace trb::drivers {
namespace {

std::optional<Severity> severity_of(std::string_view word) {
  for (const Severity severity : {Severity::warning, Severity::urgent, Severity::critical, Severity::fatal}) {
    if (word == name_of(severity)) return severity;
  }
  return std::nullopt;
}

std::string_view take_word(std::string_view& text) {
  const std::size_t end = std::min(text.find(' '), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return word;
}

}  // namespace

FaultSaid read_fault_text(std::string_view text, const std::vector<std::string>& capabilities, std::string cause) {
  std::string_view rest = text;
  const std::string capability(take_word(rest));
  const auto severity = severity_of(take_word(rest));
  const bool named = severity && std::ranges::find(capabilities, capability) != capabilities.end();
  if (named) return FaultSaid{capability, *severity, std::string(rest), std::move(cause)};
  return FaultSaid{"", Severity::critical, std::string(text), std::move(cause)};
}

}  // namespace trb::drivers
