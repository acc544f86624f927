// Reads one JSON file of a configuration.
#pragma once

#include <optional>
#include <string>

#include "common/fleet/object_reader.hpp"
#include "proto/value.hpp"

namespace trb {

/// Empty if the file cannot be read or parsed; the fault is reported. `hint` is for a missing file; an empty hint means
/// that the file is optional.
std::optional<Value> load_json(const std::string& path, const std::string& hint, const FileFaults& faults);

}  // namespace trb
