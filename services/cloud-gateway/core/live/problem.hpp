// All faults of a request at once, as an RFC 9457 problem. Only data: the shell encodes it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/config_fault.hpp"
#include "common/base/result.hpp"

namespace trb::gateway {

struct ProblemFault {
  std::string pointer;  ///< RFC 6901, into the request's body; empty: the whole body
  std::string detail;
  std::string hint;
  bool operator==(const ProblemFault&) const = default;
};

struct Problem {
  std::string type;  ///< a URI reference
  std::string title;
  std::uint16_t status = 0;
  std::string detail;
  std::vector<ProblemFault> errors;
};

/// The HTTP status of an expected failure.
std::uint16_t status_of(Errc code);

/// If the text begins with a field's path ("tasks[3].id: ..."), the fault points there.
Problem problem_of(const Error& error);
/// A problem with all faults; `code` is their kind.
Problem problem_of(const ConfigFaults& faults, Errc code = Errc::bad_value);

/// "tasks[3].skills.go_to" as "/tasks/3/skills/go_to".
std::string pointer_of(std::string_view path);

}  // namespace trb::gateway
