#include "services/sensor-bus/io/bus_message.hpp"

#include <algorithm>
#include <array>
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

using Take = BusArgument (*)(sdbus::Message&);
struct BasicType {
  char letter;
  Take take;
};
/// D-Bus' letters for the types of which a value may be.
constexpr std::array kBasicTypes{
    BasicType{'y', take<std::uint8_t, std::uint64_t>},
    BasicType{'b', take<bool, bool>},
    BasicType{'n', take<std::int16_t, std::int64_t>},
    BasicType{'q', take<std::uint16_t, std::uint64_t>},
    BasicType{'i', take<std::int32_t, std::int64_t>},
    BasicType{'u', take<std::uint32_t, std::uint64_t>},
    BasicType{'x', take<std::int64_t, std::int64_t>},
    BasicType{'t', take<std::uint64_t, std::uint64_t>},
    BasicType{'d', take<double, double>},
    BasicType{'s', take_text},
};

BusArgument read_argument(sdbus::Message& message, int depth) {
  std::string type;
  std::string contents;
  message.peekType(type, contents);
  const char letter = type.empty() ? '\0' : type.front();
  if (const auto basic = std::ranges::find(kBasicTypes, letter, &BasicType::letter); basic != kBasicTypes.end()) {
    return basic->take(message);
  }
  if (letter != 'v' || depth >= kDeepest) return std::monostate{};
  message.enterVariant(contents);
  BusArgument inside = read_argument(message, depth + 1);
  if (!std::holds_alternative<std::monostate>(inside)) message.exitVariant();
  return inside;
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
