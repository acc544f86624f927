// The notation of commands.json for a robot that answers each line of text with one.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/drivers/tcp-dialogue/pattern.hpp"
#include "common/drivers/text/vendor_template.hpp"
#include "proto/value.hpp"

namespace trb::drivers {

/// "lf", "crlf", "cr" and "nul" are what they say; any other text is itself. Errors: bad_value (over 32 bytes).
Result<std::string> read_text_end(std::string_view text);

/// One line of a command: "WORDS [-> PATTERN [else PATTERN]]", for example
///   MovJ(joint={{0},{1},{2},{3},{4},{5}})
///   goto {0} -> Arrived at * else Failed going to *
struct DialogueLine {
  std::string text;  ///< the words, as commands.json has them
  VendorTemplate words;
  std::optional<Pattern> end;      ///< the command is over at a later line like this, not at its answer
  std::optional<Pattern> failure;  ///< or has failed at one like this
};

/// One a line, 16 at most. `line_end`: no words may contain it. Errors: bad_value.
Result<std::vector<DialogueLine>> read_dialogue_lines(std::string_view text, const std::string& line_end);

/// A line without placeholders ("begin", "keep_alive", a question). Errors: bad_value.
Result<std::string> read_fixed_line(std::string_view text, const std::string& line_end);

/// "LINE -> PATTERN [where TEXT=NUMBER ...]", for example
///   GetAngle() -> 0,{{0},{1},{2},{3},{4},{5}},*
///   programState -> {0} * where STOPPED=0 PLAYING=1
struct DialogueQuestion {
  std::string line;
  Pattern pattern;
  std::map<std::string, double, std::less<>> numbers;  ///< of texts; none: texts have no number
};

/// Errors: bad_value.
Result<DialogueQuestion> read_dialogue_question(std::string_view text, const std::string& line_end);

/// The words with the data in them, ready to be followed by `line_end`. Without a line end only letters, digits and
/// + - . _ may be filled in; with one, texts on one line without quotes and backslashes. Errors: bad_value,
/// not_escapable.
Result<std::string> fill_dialogue_line(const DialogueLine& line, BytesView data, const std::string& line_end);

/// A number, if the text is one and finite; else the text.
Value value_of_text(std::string_view text);

}  // namespace trb::drivers
