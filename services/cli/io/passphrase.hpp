// The passphrase of a fleet's authority, or of a backup.
#pragma once

#include <string>

#include "common/base/result.hpp"
#include "services/cli/core/arguments.hpp"

namespace trb::cli {

/// --passphrase-file, else TRB_PASSPHRASE, else the terminal (twice for a fresh one). Errors: missing, bad_value.
Result<std::string> ask_for_passphrase(const Arguments& arguments, bool fresh,
                                       const std::string& what = "passphrase of the fleet's authority");

}  // namespace trb::cli
