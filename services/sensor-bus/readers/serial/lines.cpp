#include "services/sensor-bus/readers/serial/lines.hpp"

namespace trb::sensor {
namespace {

std::optional<std::string_view> field_of(std::string_view line, char separator, std::size_t number) {
  while (--number > 0) {
    const std::size_t at = line.find(separator);
    if (at == std::string_view::npos) return std::nullopt;
    line.remove_prefix(at + 1);
  }
  return line.substr(0, line.find(separator));
}

}  // namespace

Result<std::optional<Measured>> parse_line(const SensorRule& rule, const SensorChannel& channel,
                                           std::string_view line) {
  std::optional<std::string_view> found = line;
  if (channel.pattern) found = channel.pattern->find(line);
  if (channel.field) found = field_of(line, rule.separator, *channel.field);
  if (!found) return std::optional<Measured>();
  if (channel.is_text) {
    Measured value{true, 0, plain_text(*found)};
    if (value.text.empty()) return std::optional<Measured>();
    return std::optional<Measured>(std::move(value));
  }
  const auto number = parse_finite(*found);
  if (!number) return number.error();
  return std::optional<Measured>(Measured{false, *number, {}});
}

}  // namespace trb::sensor
