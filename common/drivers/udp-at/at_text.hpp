// AT commands ready to be sent: the lines of commands.json filled with a message's data.
#pragma once

#include <string>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/drivers/udp-at/syntax.hpp"

namespace trb::drivers {

/// One line, filled.
struct AtOrder {
  AtAction action{};
  std::string name;       ///< of `send`
  std::string arguments;  ///< as sent after the sequence number; of `move`: the four numbers
  double duration_s = 0;  ///< 0: none given
};

/// {0}, {1} … are the items of a JSON list, or the parts of a text separated by blanks; {data} is all of it. Errors:
/// bad_value, not_escapable; each names the command.
Result<std::vector<AtOrder>> fill_at_lines(const std::vector<AtLine>& lines, BytesView data);

/// `AT*NAME=SEQUENCE,ARGUMENTS\r`
std::string at_line(std::string_view name, std::uint32_t sequence, std::string_view arguments);

}  // namespace trb::drivers
