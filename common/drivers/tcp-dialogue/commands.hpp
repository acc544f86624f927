// The parsed content of commands.json for a robot that is asked and answers in text.
#pragma once

#include "common/drivers/tcp-dialogue/syntax.hpp"
#include "common/drivers/vendor_faults.hpp"

namespace trb::drivers {

/// How such a robot is spoken to, whatever is said.
struct DialogueManner {
  std::string line_end = "\n";
  std::string answer_end = "\n";
  bool greeting = false;           ///< its first line comes before any question
  std::vector<std::string> begin;  ///< lines after each connect
  std::vector<Pattern> good;       ///< a command's answer is like one of them; none: any is good
  std::vector<Pattern> bad;        ///< an answer like one of them is a refusal
  std::vector<Pattern> ignored;    ///< lines that it sends by itself
  std::string keep_alive;          ///< empty: none
  double keep_alive_s = 0;         ///< how long it may hear nothing
  double poll_s = 0.5;
  double timeout_s = 1;  ///< a stop waits at most this long for the answer in progress

  [[nodiscard]] bool is_bad(std::string_view answer) const;
  /// Of a line of a command or of "begin".
  [[nodiscard]] bool is_good(std::string_view answer) const;
  /// False: any answer is good, so that an answer to a stop shows only that the robot has heard it.
  [[nodiscard]] bool judges() const { return !good.empty() || !bad.empty(); }
  [[nodiscard]] bool ignores(std::string_view line) const;
};

struct DialogueCommands {
  DialogueManner manner;
  std::map<std::string, std::vector<DialogueLine>, std::less<>> commands;  ///< by subtype
  std::map<std::string, DialogueQuestion, std::less<>> values;             ///< by name
};

/// Checks that stop and release need no data and are over at their answers. What cannot be parsed is left out.
DialogueCommands read_dialogue_commands(const VendorCommands& vendor, const Description& description,
                                        const VendorFaults& faults);

}  // namespace trb::drivers
