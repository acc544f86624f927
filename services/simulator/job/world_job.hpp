// A job for the world: the keys of a simulation with the real cores.
#pragma once

#include "common/fleet/object_reader.hpp"
#include "services/simulator/world/world.hpp"

namespace trb::simulator {

/// Keys: `robots`, `tasks`; optional: `runs` (1; the tasks are divided into so many, which go on at once) and `at_once`
/// (false; robots do not wait for each other): see world::Division; `task_seconds` (3), `deviation` (0, of a task's
/// time), `link`: see link_job.hpp; `seed` (1), `until_event` (it ends behind that event), `seconds` (at most so many
/// are simulated, from the run's submission; 0, or without it: see WorldPlan::until_s), `faults` and `relays`: see
/// fault_job.hpp; `sensor_values`: see sensor_job.hpp.
world::WorldPlan read_world(ObjectReader& reader);

constexpr std::size_t kMaxListedAlerts = 100;  ///< and of each so many tasks

/// What the world adds to the answer; `state`: the cloud's word of the run, OPEN until its disk has the run's end;
/// `cut_off`: true, if the time was up before the run was over everywhere. Then also why:
/// `alerts` that wait for a person ([{"robot", "cause", "text", "tasks"}]), `stands_still_s` (nothing has moved for so
/// long, and nothing planned is to come; left out: something may move), `at_work` (robots at a task),
/// `finished_at_cloud` (it is; nodes keep a run for a minute more), `open_at` (nodes where it is not over), `off` (of
/// these, whose processes do not run).
/// `all_linked`: every pair of nodes had its link at `linked_s`; false: it had not, and that is when nobody waited any
/// longer. `not_reached`, [{"fault", "at"}]: faults of the plan, by index, whose time was not before the end.
/// `steps_not_reached`, if there are any, [{"sensor", "at", "steps"}]: the same of steps of `sensor_values`, and of a
/// ramp's begin and end: the first one of a sensor, and how many.
Value world_value(const world::Played& played);

/// Of a run that was played beside the first: {"scenario", "after_s"} as planned, and {"state", "over_everywhere",
/// "tasks_done", "makespan_s", "submitted_s", "broken"}, and why it was `cut_off`, as above. One that was not submitted
/// before the end has `submitted_s` 0.
Value::Object beside_value(const world::WorldRun& run);

}  // namespace trb::simulator
