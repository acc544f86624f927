#include "common/operator/doctor/use_findings.hpp"

#include <algorithm>
#include <string_view>

namespace trb::op {
namespace {

Finding finding_of(const Route& route, const OutOfUse& one) {
  const std::string since = " since " + to_iso8601({one.since}) + ": " + one.text;
  if (one.retired) {
    return {Weight::note, "robot_retired", route.id, "the robot is retired by " + one.by + since,
            "trb robot return " + route.id};
  }
  const std::string what = one.capability.empty() ? "the robot" : "'" + one.capability + "'";
  const std::string which = one.capability.empty() ? "" : " --capability " + one.capability;
  return {route.state == "self" ? Weight::problem : Weight::note, "fault_stands", route.id,
          what + " is out of use" + since,
          "mend it; if the robot itself does not say so: trb robot repaired " + route.id + which};
}

void add_runs(const Observed& seen, std::vector<Finding>& out) {
  const RunTable& table = seen.runs;
  if (table.open_max == 0 || std::uint64_t{table.open} * 10 <= std::uint64_t{table.open_max} * 9) return;
  out.push_back({Weight::note, "runs_full", seen.node,
                 std::to_string(table.open) + " runs are not over, of " + std::to_string(table.open_max) +
                     " that it takes: soon it refuses new ones",
                 "see what they wait for: trb run list; end what nobody needs: trb scenario abort RUN"});
}

/// What must never be: a person should know of it even if its run is long over.
struct NeverCounted {
  Weight weight{};
  std::string_view counter;
  std::string_view what;
};
constexpr NeverCounted kNever[] = {
    {Weight::note, "double_execution", "of one task, two different results have come: it was done twice"},
    {Weight::note, "double_choice", "of one condition, two different choices have come: the first one holds"},
};

void add_never_counted(const Observed& seen, std::vector<Finding>& out) {
  for (const auto& [weight, counter, what] : kNever) {
    const auto found = std::ranges::find(seen.scheduler.values, counter, &Counter::name);
    if (found == seen.scheduler.values.end() || found->value == 0) continue;
    out.push_back({weight, std::string(counter), seen.scheduler.node,
                   std::string(what) + " (" + std::to_string(found->value) + " since the scheduler's start)",
                   "its log names run and task: trb logs NODE_DIR scheduler; look at what was really done"});
  }
}

}  // namespace

void add_use_findings(const Observed& seen, std::vector<Finding>& out) {
  add_runs(seen, out);
  add_never_counted(seen, out);
  for (const Route& route : seen.routes.routes) {
    const bool asked = seen.asked.empty() || seen.asked == route.id || seen.asked == route.address;
    if (!asked && route.state != "self") continue;
    for (const OutOfUse& one : route.profile.out_of_use) out.push_back(finding_of(route, one));
  }
}

}  // namespace trb::op
