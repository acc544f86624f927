#include "services/simulator/job/job.hpp"

#include <algorithm>

#include "common/fleet/object_reader.hpp"
#include "services/simulator/job/world_job.hpp"

namespace trb::simulator {
namespace {

using counting::Plan;
using counting::PlannedTask;

constexpr std::int64_t kMaxRequests = 1'000'000;
constexpr std::size_t kMaxPath = 4096;
constexpr double kMaxRate = 1000;
constexpr double kMaxUpdates = 1e8;

std::uint32_t count(ObjectReader& reader, std::string_view key, std::int64_t least, std::int64_t most, Need need) {
  return static_cast<std::uint32_t>(reader.integer(key, need, least, most).value_or(least));
}

void spread(Plan& plan, std::uint32_t requests, std::uint32_t PlannedTask::*of) {
  for (std::uint32_t i = 0; i < requests; ++i) ++(plan.tasks[i % plan.tasks.size()].*of);
}

void read_devices(ObjectReader& reader, Plan& plan) {
  const std::uint32_t devices = count(reader, "sensors", 0, counting::kMaxDevices, Need::optional);
  const double rate = reader.number("rate", Need::optional, {0, kMaxRate}).value_or(1);
  plan.seconds = reader.number("seconds", Need::optional, {0, kSeconds.to}).value_or(0);
  plan.task_s = reader.number("task_seconds", Need::optional, kSeconds).value_or(plan.task_s);
  const double until = plan.seconds > 0 ? plan.seconds : plan.task_s * static_cast<double>(plan.tasks.size());
  if (devices * rate * until > kMaxUpdates) {
    reader.faults().add("sensors", "they would send over 1e8 updates", "use fewer, a lower rate or fewer seconds");
    return;
  }
  plan.device_rates.assign(devices, rate);
}

void read_requests(ObjectReader& reader, Plan& plan) {
  const std::uint32_t local = count(reader, "local_requests", 0, kMaxRequests, Need::optional);
  const std::uint32_t remote = count(reader, "remote_requests", 0, kMaxRequests, Need::optional);
  if (local + remote > 0 && plan.device_rates.empty()) {
    reader.faults().add("sensors", "there is none to send a request to", "use at least 1");
  }
  if (remote > 0 && plan.robots == 1) {
    reader.faults().add("remote_requests", "there is no other robot", "use local_requests, or more robots");
  }
  spread(plan, local, &PlannedTask::local_requests);
  spread(plan, remote, &PlannedTask::remote_requests);
}

void read_faults(ObjectReader& reader, Plan& plan) {
  const std::int64_t most = std::min<std::int64_t>(plan.robots - 1, static_cast<std::int64_t>(plan.tasks.size()));
  const std::uint32_t failed = count(reader, "faulty", 0, most, Need::optional);
  for (std::uint32_t i = 0; i < failed; ++i) plan.tasks[i].taken_over = true;
}

}  // namespace

Job read_job(std::string_view text, ConfigFaults& faults) {
  const FileFaults into("job", faults);
  const auto json = parse_json(text, kJobLimits);
  if (!json) {
    into.add("", json.error().what, json.error().hint);
    return {};
  }
  ObjectReader reader(*json, "", into);
  if (reader.choice("protocol", Need::optional, {"paper", "talkrobots"}).value_or(0) == 1) {
    Job job;
    job.world = read_world(reader);
    if (json->find("beside") != nullptr) job.alone = reader.boolean("alone", Need::optional).value_or(false);
    job.trace = reader.text("trace", Need::optional, kMaxPath).value_or("");
    reader.refuse_unknown_keys();
    return job;
  }
  const std::uint32_t robots = count(reader, "robots", 1, counting::kMaxPlannedRobots, Need::required);
  const std::uint32_t tasks = count(reader, "tasks", 1, counting::kMaxPlannedTasks, Need::required);
  const std::uint32_t interpreted = count(reader, "interpreted", 0, robots, Need::optional);
  auto plan = counting::cyclic_plan(robots, tasks, interpreted);
  if (!plan) {
    into.add("", plan.error().what, plan.error().hint);
    return {};
  }
  Job job{.plan = std::move(*plan),
          .world = {},
          .alone = false,
          .trace = reader.text("trace", Need::optional, kMaxPath).value_or("")};
  read_devices(reader, job.plan);
  read_requests(reader, job.plan);
  read_faults(reader, job.plan);
  reader.refuse_unknown_keys();
  return job;
}

}  // namespace trb::simulator
