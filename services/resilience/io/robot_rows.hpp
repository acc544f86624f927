// Converts a robot's record to rows, and back.
#pragma once

#include <vector>

#include "common/sqlite/sqlite_file.hpp"
#include "services/resilience/core/fleet.hpp"

namespace trb::resilience {

/// Writes these parts (Changes::Part) of the record. Must run within a transaction.
Status write_robot(SqliteFile& file, const RobotRecord& robot, unsigned parts);
Status delete_robot(SqliteFile& file, const std::string& id);

/// Every robot, by id. Errors: malformed (rows that no build has written), io_error.
Result<std::vector<RobotRecord>> read_robots(SqliteFile& file);

}  // namespace trb::resilience
