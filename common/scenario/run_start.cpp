#include "common/scenario/run_start.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include "common/base/ids.hpp"
#include "common/scenario/decision_rule.hpp"
#include "common/scenario/graph.hpp"
#include "common/scenario/run_id.hpp"
#include "common/security/keys.hpp"
#include "proto/body.hpp"

namespace trb {
namespace {

Result<std::set<std::string>> check_members(const RunStart& start) {
  std::set<std::string> ids;
  for (const Member& member : start.members) {
    if (auto id = check_id("members", member.id); !id) return id.error();
    if (!ids.insert(member.id).second) return fail(Errc::duplicate, "member '" + member.id + "' occurs twice");
  }
  if (!ids.contains(start.submitter)) return fail(Errc::bad_value, "submitter '" + start.submitter + "' is no member");
  std::set<std::string> electors;
  for (const std::string& elector : start.electorate) {
    if (!ids.contains(elector)) return fail(Errc::bad_value, "elector '" + elector + "' is no member");
    if (!electors.insert(elector).second) return fail(Errc::duplicate, "elector '" + elector + "' occurs twice");
  }
  if (electors.empty()) return fail(Errc::bad_value, "electorate is empty");
  return ids;
}

Status check_times(const RunStart& start) {
  constexpr std::int64_t kLongest = std::chrono::nanoseconds(std::chrono::hours(24 * 366)).count();
  constexpr std::int64_t kLatest = std::numeric_limits<std::int64_t>::max() - 2 * kLongest;
  if (start.created < 0 || start.created > kLatest) return fail(Errc::bad_value, "created: no time of this age");
  if (start.expires <= start.created) return fail(Errc::bad_value, "run " + start.run + " ends before it begins");
  if (start.expires - start.created > kLongest)
    return fail(Errc::bad_value, "expires: more than 366 days after created");
  return Done{};
}

Status check_assignment(const RunStart& start, const std::set<std::string>& members) {
  const auto& robots = start.first.robots;
  if (start.first.epoch != 1)
    return fail(Errc::conflict, "epoch " + std::to_string(start.first.epoch) + " is not the first");
  if (robots.size() != start.scenario.tasks.size()) return fail(Errc::bad_value, "first: not one robot for every task");
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const Task& task = start.scenario.tasks[i];
    if (!members.contains(robots[i])) {
      return fail(Errc::bad_value, "task '" + task.id + "': robot '" + robots[i] + "' is no member");
    }
    if (!task.robot.empty() && task.robot != robots[i]) {
      return fail(Errc::conflict,
                  "task '" + task.id + "' is for '" + task.robot + "', assigned to '" + robots[i] + "'");
    }
  }
  return Done{};
}

}  // namespace

std::vector<std::string> robots_of(const Assignment& assignment) {
  std::vector<std::string> out;
  std::set<std::string> seen;
  for (const std::string& robot : assignment.robots) {
    if (seen.insert(robot).second) out.push_back(robot);
  }
  return out;
}

RunStart build_run_start(Scenario scenario, std::vector<Member> members, std::string submitter, UtcTime now,
                         UtcTime expires, std::string run, std::vector<std::string> robots, std::uint32_t priority) {
  RunStart start;
  start.run = std::move(run);
  start.digest.bytes = digest(encode(scenario));
  start.first.robots = std::move(robots);
  if (start.first.robots.empty()) {
    for (const Task& task : scenario.tasks) start.first.robots.push_back(task.robot);
  }
  start.electorate = robots_of(start.first);
  std::erase_if(start.electorate, [&](const std::string& id) {
    return std::any_of(members.begin(), members.end(),
                       [&](const Member& member) { return member.id == id && says_cloud(member); });
  });
  if (start.electorate.size() % 2 == 0) {
    if (const std::string cloud = first_cloud_of(members); !cloud.empty()) start.electorate.push_back(cloud);
  }
  start.scenario = std::move(scenario);
  start.members = std::move(members);
  start.submitter = std::move(submitter);
  start.created = now.ns;
  start.expires = expires.ns;
  start.priority = priority;
  return start;
}

Status check_run_start(const RunStart& start) {
  if (auto id = check_run_id(start.run, start.submitter); !id) return id;
  if (start.priority > kMaxPriority) {
    return fail(Errc::bad_value, "priority: " + std::to_string(start.priority) + " is too high", "0 to 9");
  }
  if (auto graph = check_graph(start.scenario); !graph) return graph;
  if (start.digest.bytes != digest(encode(start.scenario))) {
    return fail(Errc::conflict, "run " + start.run + ": the digest is not the scenario's");
  }
  const auto members = check_members(start);
  if (!members) return members.error();
  if (auto times = check_times(start); !times) return times;
  return check_assignment(start, *members);
}

}  // namespace trb
