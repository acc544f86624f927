// `trb simulate --beside`: scenarios that run at the same time on the same robots, and what that costs each.
#pragma once

#include <string>
#include <vector>

#include "common/base/config_fault.hpp"
#include "proto/bodies/run.hpp"
#include "proto/value.hpp"
#include "services/cli/core/arguments.hpp"

namespace trb::cli {

/// A scenario of --beside FILE[@SECONDS].
struct Beside {
  std::string file;
  double after_s = 0;  ///< it is submitted so long after the first run
  Scenario scenario;
  Value json;  ///< the file
};

/// "b.json@20" as file and seconds; without @, or if a file has all of it as its name, 0 s.
Beside beside_of(const std::string& word);

/// Those that were given. Faults: of the files, bad seconds, over nine.
std::vector<Beside> read_beside(const Arguments& arguments, ConfigFaults& faults);

/// The job's key `beside`.
Value beside_job(const std::vector<Beside>& beside);

/// Of a run: the answer's `world`, or one of `beside`.
const Value& run_of(const Value& answer, std::size_t run);

/// A row for each run: its state, makespan and tasks; if the answer has them (`alone_s`, `waits`) the makespan alone,
/// and what it waited for other runs' robots.
void print_runs(const Value& answer);

}  // namespace trb::cli
