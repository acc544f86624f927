// The notation of commands.json for an ABB whose RAPID program takes requests as text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"

namespace trb::drivers {

/// The most characters in a RAPID string, the request's end included.
constexpr std::size_t kRapidString = 80;

/// "[service] CODE PARAMETER ...", for example `2 {0} {1} {2} {3} {4} {5}`, `20 1`, `service 91`.
struct RapidRequest {
  bool service = false;  ///< to the service task, which answers while a move blocks the program
  int code = 0;
  std::string text;  ///< "CODE PARAMETER ... #", with {data} or {0}, {1} …
};

/// One a line; each is sent once the previous one is answered. Errors: bad_value, too_large.
Result<std::vector<RapidRequest>> read_rapid_requests(std::string_view text);

/// "[service] CODE [INDEX ...]": a reading request and which of its numbers; without indices: all of them.
struct RapidQuestion {
  RapidRequest request;
  std::vector<std::size_t> indices;
};

/// Errors: bad_value.
Result<RapidQuestion> read_rapid_question(std::string_view text);

/// The values that the service task reports by itself.
const std::vector<std::string>& rapid_state_values();

}  // namespace trb::drivers
