// What a command prints: text for people, JSON for programs, colour only on a terminal.
#pragma once

#include <string>

#include "common/base/config_fault.hpp"
#include "proto/value.hpp"
#include "services/cli/core/arguments.hpp"

namespace trb::cli {

constexpr int kGood = 0;
constexpr int kFailed = 1;
constexpr int kWrongUse = 2;

/// The words of others among it cannot command the terminal: control characters are shown as \u00XX.
void print(const std::string& text);
/// To standard error, as print().
void print_problem(const std::string& text);
/// One line, whatever it holds: a newline in it is shown, unless it begins with it.
void print_line(const std::string& text);
void print_json(const Value& value);

/// To standard error, or with --json as {"error":{"code","what","cure"}} to standard output. Returns kFailed.
int print_error(const Arguments& arguments, const Error& error);

/// [{"file","key","what","cure","may_wait"}]
Value fault_list(const ConfigFaults& faults);
/// {"faults": fault_list()}
Value faults_json(const ConfigFaults& faults);

/// The same as print_error for a list of faults. `therefore` is what came of them, if the command was to do more than
/// to look: "nothing was started".
int print_faults(const Arguments& arguments, const ConfigFaults& faults, const std::string& therefore = "");

/// Empty, or why something that print() was given could not be written. The first failure counts.
const std::string& lost_output();
/// Of a program that goes on whatever becomes of its words.
void forget_lost_output();

enum class Colour { plain, good, bad, dim };
/// Wraps the text in the terminal's colour, if standard output is one and NO_COLOR is not set.
std::string coloured(Colour colour, const std::string& text);

}  // namespace trb::cli
