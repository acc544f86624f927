// The notation of commands.json for a drone that takes AT commands over UDP (Parrot AR.Drone 2).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "proto/value.hpp"

namespace trb::drivers {

/// What a line does. `send` is a maker's command that is sent once; all others change the state that is sent
/// repeatedly: in the air or on the ground, emergency, motion.
enum class AtAction : std::uint8_t { send = 0, take_off, land, emergency, recover, hover, move };

/// How an argument is written: whole number, float as the int32 of the same bits, the same within -1 … 1, text in
/// quotes; seconds are not sent.
enum class AtType : std::uint8_t { integer = 0, real, tilt, text, seconds };

struct AtArgument {
  static constexpr int kLiteral = -1;
  static constexpr int kWhole = -2;  ///< {data}
  AtType type{};
  int item = kLiteral;  ///< the part of the data that fills it: {0}, {1} …
  Value literal{};
};

/// One line: a command of the maker's without its sequence number.
///   REF take_off | REF land | REF emergency | REF recover
///   hover [for SECONDS]
///   PCMD ROLL PITCH GAZ YAW [for SECONDS]
///   FTRIM | CALIB DEVICE | CONFIG "KEY" VALUE | LED ANIMATION FREQUENCY SECONDS | ANIM ANIMATION MILLISECONDS
struct AtLine {
  AtAction action{};
  std::string name;  ///< of `send`: "LED"
  std::vector<AtArgument> arguments;
  std::vector<AtArgument> duration;  ///< none, or the seconds
};

/// At most 8 lines, at most one of them of REF, hover and PCMD. Errors: bad_value, which names the line and what it
/// should be.
Result<std::vector<AtLine>> read_at_lines(std::string_view text);

/// The argument as sent in the datagram. Errors: bad_value (type, range), not_escapable: the protocol has no escape for
/// a quote or a line's end within a text.
Result<std::string> at_literal(AtType type, const Value& value);

/// Seconds of a duration. Errors: bad_value.
Result<double> at_seconds(const Value& value);

/// True if the drone's mode can detect the end of that line.
bool at_tells_end(const AtLine& line);

/// The names of navdata's values: "battery", "altitude", "emergency" …
const std::vector<std::string>& at_value_names();

}  // namespace trb::drivers
