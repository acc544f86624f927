#include "services/scheduler/core/awaited_robots.hpp"

#include <algorithm>
#include <vector>

#include "common/security/keys.hpp"
#include "proto/bodies/bus.hpp"
#include "proto/body.hpp"
#include "proto/value.hpp"
#include "services/scheduler/core/obstacle.hpp"

namespace trb::scheduler {
namespace {

constexpr std::size_t kMaxObstacle = 512;

bool awaits_other(const Run& run, TaskIndex task) {
  return !run.epochs().is_own(task) && !run.work().timers().waits(task);
}

constexpr const char* kNewKeys =
    "its node has got new keys since, and can do no more of the run; trb alert decide gives the task to another, with "
    "--stands once somebody has seen that the robot stands";

/// Does the run know other keys of that node? The table's certificates are the authority's word.
bool has_new_keys(const Run& run, const Route& route) {
  const Certificate* member = run.members().find(route.id);
  const auto now = decode<Certificate>(route.certificate.payload.bytes);
  return member != nullptr && now && has_newer_keys(*now, *member);
}

std::string obstacle_in(const Run& run, const Route& route, const std::string& skill) {
  if (has_new_keys(run, route)) return kNewKeys;
  if (route.state != "ONLINE" && route.state != "self") return "its node is not reached";
  return cut_utf8(obstacle_of(route.profile, skill), kMaxObstacle);
}

}  // namespace

/// When the table is wanted because of the run; nothing: it waits for nobody else's robot.
std::optional<MonotonicTime> AwaitedRobots::wanted_at(const Run& run) const {
  std::optional<MonotonicTime> out;
  for (const auto& [task, since] : run.work().timers().due_since()) {
    if (!awaits_other(run, task)) continue;
    const bool is_new = !asked_ || since + kPatience > *asked_;
    out = earlier(out, is_new ? since + kPatience : *asked_ + kAgain);
  }
  // Many tasks that become due one after the other do not make it ask more often than that.
  return out && asked_ ? std::max(*out, *asked_ + kPatience) : out;
}

std::optional<MonotonicTime> AwaitedRobots::wanted_at() const {
  std::optional<MonotonicTime> out;
  for (const Run* run : runs_.runs()) out = earlier(out, wanted_at(*run));
  return out;
}

void AwaitedRobots::look(const Run& run, Step step) {
  const auto at = wanted_at(run);
  if (at) next_ = earlier(next_, std::max(*at, step.now.mono));
}

void AwaitedRobots::tick(Step step) {
  if (!next_ || *next_ > step.now.mono) return;
  next_ = wanted_at();
  if (!next_ || *next_ > step.now.mono) return;
  step.out.request(node_, RouteListRequest{});
  asked_ = step.now.mono;
  next_ = wanted_at();
}

void AwaitedRobots::on_routes(const RouteTable& table) const {
  for (const Run* run : runs_.runs()) {
    for (const auto& [task, since] : run->work().timers().due_since()) {
      if (!awaits_other(*run, task)) continue;
      const std::string& robot = run->epochs().robot_of(task);
      const auto route = std::ranges::find(table.routes, robot, &Route::id);
      const std::string why = route == table.routes.end() ? "" : obstacle_in(*run, *route, run->tasks()[task].skill);
      if (run->reports().obstacle_of(task, robot) != why)
        runs_.find(run->id())->reports().note_obstacle(task, robot, why);
    }
  }
}

}  // namespace trb::scheduler
