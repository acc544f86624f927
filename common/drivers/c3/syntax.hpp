// The notation of commands.json for a KUKA whose variables are read and written over C3 (KUKAVARPROXY).
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"

namespace trb::drivers {

/// "VARIABLE = VALUE", for example `TRB_AXIS = {E6AXIS: A1 {0}, A2 {1}}`, `TRB_TOOL[] = {0}`, `TRB_STOP = TRUE`.
struct C3Assignment {
  std::string variable;
  std::string value;  ///< in KRL, with {data} or {0}, {1} …; a text includes its own quotes
};

/// One a line. Errors: bad_value (no variable, or not a KRL value once the placeholders are filled).
Result<std::vector<C3Assignment>> read_c3_assignments(std::string_view text);

/// "VARIABLE [COMPONENT ...]", for example `$POS_ACT X Y Z`; without components: all of it.
struct C3Question {
  std::string variable;
  std::vector<std::string> components;
};

/// Errors: bad_value.
Result<C3Question> read_c3_question(std::string_view text);

/// The variables of the hand-shake between the node and the robot's program; `values` may rename them. Empty: it does
/// not exist.
struct C3Names {
  // a message for the robot, field by field
  std::string type, subtype, source, size, data;
  std::string chunk;    ///< node: TRUE, data holds a chunk that is not the last; program: FALSE, taken
  std::string number;   ///< of the message
  std::string command;  ///< node: TRUE, the message is complete; program: FALSE, taken
  // its end
  std::string done;         ///< program: TRUE, over; node: FALSE, read
  std::string done_number;  ///< of the message that is over
  std::string result;       ///< 0: success
  std::string text;         ///< the result, or why not; the answer to a request
  // a message of the robot's
  std::string out;  ///< program: TRUE, it is ready; node: FALSE, read
  std::string out_type, out_subtype, out_target, out_size, out_data;
  // its state
  std::string stopped;       ///< TRUE while it is stopped by the node
  std::string stop_message;  ///< TRUE while the controller has stopped the program itself
  std::string error;         ///< the program's text about a fault
};

/// True for the names of `values` that name a part of the hand-shake: they begin with "trb_".
bool is_c3_name(std::string_view name);

/// With `fields` the robot has all of them, under the names of config/robots/kuka/trb.dat unless `values` renames them;
/// otherwise only those that `values` names. Errors: unknown_key (an unknown trb_ name; the text names it).
Result<C3Names> read_c3_names(const std::map<std::string, std::string>& values, bool fields);

}  // namespace trb::drivers
