#include "services/virtual-robots/drone/commands.hpp"

#include <bit>
#include <cmath>
#include <limits>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::drone {
namespace {

bool is_name(std::string_view text) {
  for (const char c : text) {
    if ((c < 'A' || c > 'Z') && c != '_') return false;
  }
  return !text.empty();
}

/** Splits at commas outside of quotes; nothing if a quote is not closed or stands within a word. */
std::optional<std::vector<std::string>> split_arguments(std::string_view text) {
  std::vector<std::string> arguments;
  for (;;) {
    const bool quoted = text.starts_with('"');
    const std::size_t end = quoted ? text.find('"', 1) : std::min(text.find(','), text.size());
    if (end == std::string_view::npos) return std::nullopt;
    arguments.emplace_back(quoted ? text.substr(1, end - 1) : text.substr(0, end));
    if (!quoted && arguments.back().find('"') != std::string::npos) return std::nullopt;
    text.remove_prefix(quoted ? end + 1 : end);
    if (text.empty()) return arguments;
    if (text.front() != ',') return std::nullopt;
    text.remove_prefix(1);
  }
}

std::optional<Command> parse_line(std::string_view line) {
  if (!line.starts_with("AT*")) return std::nullopt;
  line.remove_prefix(3);
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos || !is_name(line.substr(0, equals))) return std::nullopt;
  auto arguments = split_arguments(line.substr(equals + 1));
  const auto sequence = arguments ? parse_integer(arguments->front()) : std::nullopt;
  if (!sequence || *sequence < 0 || *sequence > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  arguments->erase(arguments->begin());
  return Command{std::string(line.substr(0, equals)), static_cast<std::uint32_t>(*sequence), std::move(*arguments)};
}

}  // namespace

Datagram parse_datagram(std::string_view bytes) {
  Datagram out;
  if (bytes.size() > kLongestDatagram) {
    out.rejected.emplace_back("longer than 1024 bytes");
    return out;
  }
  while (!bytes.empty()) {
    const std::size_t end = bytes.find('\r');
    const std::string_view line = bytes.substr(0, end);
    auto command = end == std::string_view::npos ? std::nullopt : parse_line(line);
    if (command) {
      out.commands.push_back(std::move(*command));
    } else {
      out.rejected.emplace_back(line);
    }
    if (end == std::string_view::npos) break;
    bytes.remove_prefix(end + 1);
  }
  return out;
}

std::optional<std::int32_t> integer_argument(const Command& command, std::size_t index) {
  if (index >= command.arguments.size()) return std::nullopt;
  const auto number = parse_integer(command.arguments[index]);
  if (!number || *number < std::numeric_limits<std::int32_t>::min() ||
      *number > std::numeric_limits<std::int32_t>::max()) {
    return std::nullopt;
  }
  return static_cast<std::int32_t>(*number);
}

std::optional<float> float_argument(const Command& command, std::size_t index) {
  const auto bits = integer_argument(command, index);
  if (!bits) return std::nullopt;
  const auto number = std::bit_cast<float>(*bits);
  if (!std::isfinite(number)) return std::nullopt;
  return number;
}

}  // namespace trb::virtual_robots::drone
