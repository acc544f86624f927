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

constexpr std::size_t kMostBeside = 9;

/// "b.json@20" as file and seconds; without @, or if a file has all of it as its name, 0 s.
Beside beside_of(const std::string& word);

/// Those that were given. Faults: of the files, bad seconds, over nine.
std::vector<Beside> read_beside(const Arguments& arguments, ConfigFaults& faults);

/// The job's key `beside`.
Value beside_job(const std::vector<Beside>& beside);

/// A row for each run: its state, makespan and tasks; `alone`, by run, if it is not empty, the makespan alone, or why
/// there is none; what it waited for other runs' robots, of `waits` (see waits_value), by run.
void print_runs(const Value& answer, const std::vector<std::string>& alone = {}, const std::vector<Value>& waits = {});

}  // namespace trb::cli
