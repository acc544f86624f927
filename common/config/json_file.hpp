// Reads one JSON file of a configuration.
#pragma once

#include <optional>
#include <string>

#include "common/fleet/object_reader.hpp"
#include "proto/value.hpp"

namespace trb {

/// Nothing if it cannot be read or parsed, which is then told. `hint` is for a file that is not there; an empty one
/// means that it need not be.
std::optional<Value> load_json(const std::string& path, const std::string& hint, const FileFaults& faults);

}  // namespace trb
