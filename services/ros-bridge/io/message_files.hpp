// Message definitions in folders: DIR/PACKAGE/msg/NAME.msg, as Debian installs them below /usr/share.
#pragma once

#include <string>
#include <vector>

#include "common/base/result.hpp"

namespace trb::ros {

/// The text of a type's definition from the first folder that has it. `type` must be a type name (is_type_name).
/// Errors: missing (names the folders), too_large, io_error.
Result<std::string> read_message_file(const std::vector<std::string>& folders, const std::string& type);

/// Every type that the folders define, sorted.
std::vector<std::string> list_message_types(const std::vector<std::string>& folders);

}  // namespace trb::ros
