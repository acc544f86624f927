#include "services/sensor-bus/io/bus_message.hpp"

#include <cstring>

namespace trb::sensor {
namespace {

constexpr std::size_t kMostArguments = 4;
constexpr int kDeepest = 4;  ///< variants in variants

template <class Wire, class Out>
BusArgument take(sdbus::Message& message) {
  Wire value{};
  message >> value;
  return Out(value);
}

BusArgument take_text(sdbus::Message& message) {
  char* text = nullptr;  // points into the message: a huge text is copied only if it is taken
  message >> text;
  if (text == nullptr) return std::monostate{};
  // One byte more than is taken tells that it is too long.
  return std::string(text, ::strnlen(text, kMaxValueText + 1));
}

BusArgument read_argument(sdbus::Message& message, int depth) {
  std::string type;
  std::string contents;
  message.peekType(type, contents);
  switch (type.empty() ? '\0' : type.front()) {
    case 'y':
      return take<std::uint8_t, std::uint64_t>(message);
    case 'b':
      return take<bool, bool>(message);
    case 'n':
      return take<std::int16_t, std::int64_t>(message);
    case 'q':
      return take<std::uint16_t, std::uint64_t>(message);
    case 'i':
      return take<std::int32_t, std::int64_t>(message);
    case 'u':
      return take<std::uint32_t, std::uint64_t>(message);
    case 'x':
      return take<std::int64_t, std::int64_t>(message);
    case 't':
      return take<std::uint64_t, std::uint64_t>(message);
    case 'd':
      return take<double, double>(message);
    case 's':
      return take_text(message);
    case 'v': {
      if (depth >= kDeepest) return std::monostate{};
      message.enterVariant(contents);
      BusArgument inside = read_argument(message, depth + 1);
      if (!std::holds_alternative<std::monostate>(inside)) message.exitVariant();
      return inside;
    }
    default:
      return std::monostate{};
  }
}

}  // namespace

std::vector<BusArgument> read_arguments(sdbus::Message& message) {
  std::vector<BusArgument> out;
  std::string type;
  std::string contents;
  while (out.size() < kMostArguments) {
    message.peekType(type, contents);
    if (type.empty() || type.front() == '\0') break;
    out.push_back(read_argument(message, 0));
    if (std::holds_alternative<std::monostate>(out.back())) break;
  }
  return out;
}

}  // namespace trb::sensor
