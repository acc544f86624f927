// Puts data into URScript: only as a literal, so no data can become a statement.
#pragma once

#include <string>
#include <string_view>

#include "common/base/result.hpp"
#include "proto/value.hpp"

namespace trb::drivers {

/// A number, True or False, a list of numbers, or a quoted text. Errors: bad_value (no literal of that kind),
/// not_escapable (a quote, backslash, control character or a byte outside ASCII: URScript has no escapes for them).
Result<std::string> urscript_literal(const Value& value);

/// The lines as a program with a name, so that the robot reports its start and its end. Its last line prints a text,
/// because a program that a person or a protective stop has cut short is reported as stopped, too.
std::string urscript_program(std::string_view name, std::string_view lines);

/// The text that the last line prints.
std::string urscript_end_text(std::string_view name);

/// True for the controller's interface commands that are not script statements ("power on").
bool is_interface_command(std::string_view text);

/// Can the controller execute it: an interface command, or a script, which calls a function or halts? To anything else
/// it answers by an exception, and moves on.
bool may_be_urscript(std::string_view text);

}  // namespace trb::drivers
