// The start of a run: built by a submitter, checked by every node that receives it.
#pragma once

#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "proto/bodies/run.hpp"

namespace trb {

/// Builds the start of a run, ready to be encoded and signed (purpose "run_start"). The tasks' robots become the first
/// assignment; the digest is BLAKE2b-256 of encode(scenario); the electorate is the run's robots in the order of their
/// first task, and the first cloud node among the members if their number is even. `run` is 32 random lower-case
/// hexadecimal digits. `robots` are who does each task, if some are bound late (see bind_tasks); a cloud node among
/// them is the run's decider, which chooses a robot when the task is due. Nothing is checked here: see check_run_start.
RunStart build_run_start(Scenario scenario, std::vector<Member> members, std::string submitter, UtcTime now,
                         UtcTime expires, std::string run, std::vector<std::string> robots = {},
                         std::uint32_t priority = 0);

/// Checks everything that needs no key: run id, graph, digest, an assigned member for every task, members once each,
/// submitter and electorate among them, epoch 1, times, priority. Errors: bad_value, duplicate, conflict (digest,
/// epoch) and those of check_graph.
Status check_run_start(const RunStart& start);

/// The robots of an assignment, once each, in the order of their first task.
std::vector<std::string> robots_of(const Assignment& assignment);

}  // namespace trb
