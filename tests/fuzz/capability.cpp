// What nodes and robots report about themselves, up to the candidates: profiles, values, faults, a scenario's task.
#include <algorithm>
#include <cmath>

#include "proto/body.hpp"
#include "services/resilience/core/candidates.hpp"
#include "services/resilience/core/robot_state.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::resilience;

enum Kind : unsigned char { kProfile = 0, kState, kFault, kConnection, kTask };

/// A part: its kind, its size in two bytes, its bytes.
template <class Body>
Bytes part(Kind kind, const Body& body) {
  const Bytes bytes = encode(body);
  Bytes out{static_cast<char>(kind), static_cast<char>(bytes.size() >> 8U), static_cast<char>(bytes.size())};
  return out + bytes;
}

NodeProfile robot() {
  NodeProfile profile;
  profile.mode = "ros";
  profile.capabilities = {"mobile"};
  profile.skills = {
      {"go", "mobile", {{"place", "place", true, ""}, {"speed", "number", false, "m/s", {0, 1}}}, true, 9}};
  profile.places = {"dock"};
  profile.robot = "ONLINE";
  profile.frame = {1000, 1, 2, 0.5};
  return profile;
}

Scenario one_task() {
  Scenario scenario;
  Task task;
  task.id = "t";
  task.skill = "go";
  task.data = R"({"place":"dock","speed":0.5})";
  scenario.tasks = {task};
  return scenario;
}

void check_state(const RobotRecord& robot) {
  if (const auto charge = charge_of(robot)) {
    require(charge->is >= 0 && charge->is <= 100, "a charge is a percentage");
  }
  if (const auto place = position_of(robot)) {
    require(std::isfinite(place->is.x) && std::isfinite(place->is.y), "a position is a place");
  }
  static_cast<void>(mode_of(robot));
  require(robot.values.size() <= kMaxValues && robot.faults.size() <= kMaxFaults, "a record is bounded");
}

void check_candidates(const Fleet& fleet, const Task& task) {
  const auto need = need_of(task);
  if (!need) return;
  const Candidates found = find_candidates(fleet, {{*need}, {}});
  for (const auto& [id, robot] : fleet.robots()) {
    const bool suits = is_fit(robot) && why_unable(robot, *need).empty();
    const bool is_found = std::find(found.robots.begin(), found.robots.end(), id) != found.robots.end();
    require(suits == is_found, "the index answers what the records say");
  }
  for (const Unsuitable& one : found.unsuitable) {
    require(!one.why.empty() && one.why.size() <= kMaxWhy, "a reason is given, and bounded");
  }
}

void take(Fleet& fleet, unsigned kind, BytesView bytes, UtcTime now) {
  const std::string id = "robot";
  if (kind == kProfile) {
    Route route;
    route.id = id;
    route.state = "ONLINE";
    if (auto body = decode<NodeProfile>(bytes)) route.profile = std::move(*body);
    static_cast<void>(fleet.on_route(route, now));
  } else if (kind == kState) {
    if (const auto body = decode<RobotState>(bytes)) fleet.on_state(id, *body, now);
  } else if (kind == kFault) {
    if (const auto body = decode<RobotFault>(bytes)) fleet.on_fault(id, *body, now);
  } else if (kind == kConnection) {
    if (const auto body = decode<RobotConnection>(bytes)) fleet.on_connection(id, *body, now);
  } else if (kind == kTask) {
    const auto body = decode<Scenario>(bytes);
    if (body && !body->tasks.empty()) check_candidates(fleet, body->tasks.front());
  } else {
    fleet.on_value(id, kind % 2 == 0 ? "position" : "battery", std::string(bytes), now);
  }
}

}  // namespace

std::vector<Bytes> seeds() {
  const Bytes profile = part(kProfile, robot());
  const Bytes task = part(kTask, one_task());
  const Bytes state = part(kState, RobotState{{{"battery", "0.5"}, {"position", "[1, 2]"}, {"mode", "\"AUTO\""}}});
  const Bytes fault = part(kFault, RobotFault{"mobile", Severity::critical, "motor"});
  const Bytes down = part(kConnection, RobotConnection{"CONNECTION_BROKEN", "cable"});
  return {profile + task, profile + state + task, profile + fault + task, profile + down + state + task,
          profile +
              Bytes("\x06\x00\x05"
                    "1 2 3",
                    8) +
              Bytes("\x05\x00\x03"
                    "0.5",
                    6) +
              task};
}

void run(BytesView input) {
  Fleet fleet;
  UtcTime now{1};
  static_cast<void>(fleet.on_joined("robot", now));
  while (input.size() >= 3) {
    const auto kind = static_cast<unsigned char>(input[0]);
    const std::size_t size = static_cast<unsigned char>(input[1]) * 256U + static_cast<unsigned char>(input[2]);
    input.remove_prefix(3);
    now = now + seconds(1);
    take(fleet, kind, input.substr(0, size), now);
    input.remove_prefix(std::min(size, input.size()));
    check_state(*fleet.find("robot"));
  }
}

}  // namespace trb::fuzz
