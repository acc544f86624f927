// A database's file that belongs to its owner alone.
#pragma once

#include <string>

#include "common/base/result.hpp"

namespace trb::gateway {

/// The file has the mode 0600 before SQLite writes into it; its -wal and -shm files get the same mode. An existing one
/// gets it. Errors: io_error.
Status make_private(const std::string& path);

}  // namespace trb::gateway
