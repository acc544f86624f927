// Who types.
#pragma once

#include <cstdlib>
#include <string>

#include "services/cli/core/arguments.hpp"

namespace trb::cli {

/// --person, else $USER; 64 bytes at most.
inline std::string person_of(const Arguments& arguments) {
  const char* user = std::getenv("USER");
  const std::string otherwise = user == nullptr || *user == '\0' ? "somebody" : user;
  return arguments.get("--person", otherwise).substr(0, 64);
}

}  // namespace trb::cli
