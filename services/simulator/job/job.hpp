// One simulation, as the simulator is given it: a JSON object.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/base/config_fault.hpp"
#include "proto/value.hpp"
#include "services/simulator/counting/plan.hpp"
#include "services/simulator/world/world.hpp"

namespace trb::simulator {

constexpr std::size_t kMaxJob = 4U << 20U;  ///< bytes of its JSON: a thousand robots' profiles, and a scenario
/// What parse_json takes of a job.
constexpr ParseLimits kJobLimits{.bytes = kMaxJob, .values = 1'000'000};

struct Job {
  counting::Plan plan;
  std::optional<world::WorldPlan> world;  ///< in place of the plan: with the real cores
  bool alone = false;                     ///< each of its runs by itself, too
  std::string trace;                      ///< the file that gets every message, a JSON object a line; empty: none
};

/// Keys: `robots`, `tasks` (given to the robots in turn); optional: `interpreted` (robots told field by field),
/// `task_seconds` (3), `sensors`, `rate` (1/s, each), `seconds` (until when devices send), `local_requests`,
/// `remote_requests`, `faulty`, `trace`. With `protocol` "talkrobots" ("paper") its keys are read_world()'s,
/// `trace`, and with `beside` also `alone` (false). Requests and faults go to one task after the other. Every fault is
/// added, by its key; over kJobLimits, too.
Job read_job(std::string_view text, ConfigFaults& faults);

}  // namespace trb::simulator
