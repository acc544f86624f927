#include "services/resilience/core/fleet.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/gives_way.hpp"
#include "common/base/ids.hpp"
#include "proto/body.hpp"
#include "proto/value.hpp"

namespace trb::resilience {
namespace {

constexpr std::size_t kMaxText = 255;
constexpr unsigned kToldAgain = Changes::kNode | Changes::kState;

std::string capabilities_of(const NodeProfile& profile) {
  std::string out;
  for (const std::string& word : profile.capabilities) out += (out.empty() ? "" : ", ") + word;
  return out.empty() ? "no capabilities" : out;
}

bool same_abilities(const NodeProfile& a, const NodeProfile& b) {
  return a.capabilities == b.capabilities && a.skills == b.skills && a.places == b.places && a.sensors == b.sensors &&
         a.plugged == b.plugged && a.out_of_use == b.out_of_use && a.numbers == b.numbers;
}

/// Removes values that are not numbers: they never equal themselves, and SQLite cannot store them.
NodeProfile cleaned(NodeProfile profile) {
  const FrameInfo& frame = profile.frame;
  if (!std::isfinite(frame.length + frame.x + frame.y + frame.yaw)) profile.frame = {};
  std::erase_if(profile.numbers, [](const NamedNumber& number) { return !std::isfinite(number.value); });
  for (SkillInfo& skill : profile.skills) {
    if (!std::isfinite(skill.timeout_s)) skill.timeout_s = 0;
    for (ParameterInfo& info : skill.parameters) {
      const bool readable = info.range.size() == 2 && std::isfinite(info.range[0]) && std::isfinite(info.range[1]);
      if (!readable) info.range.clear();
    }
  }
  return profile;
}

bool set_value(RobotRecord& robot, const std::string& name, const std::string& value, UtcTime now) {
  if (name.empty() || name.size() > kMaxIdSize || value.size() > kMaxValueSize) return false;
  if (robot.values.size() >= kMaxValues && !robot.values.contains(name)) return false;
  robot.values[name] = {value, now};
  return true;
}

}  // namespace

Result<RobotRecord*> Fleet::insert(std::string_view id) {
  if (Status valid = check_id("robot", id); !valid) return valid.error();
  if (robots_.size() >= kMaxRobots) {
    return fail(Errc::too_large, "the capability database has its " + std::to_string(kMaxRobots) + " robots",
                "let it forget those that have left");
  }
  const auto number = index_.add(id);
  if (!number) return number.error();
  RobotRecord& robot = robots_[std::string(id)];
  robot.id = id;
  if (by_number_.size() <= *number) by_number_.resize(*number + 1);
  by_number_[*number] = &robot;
  return &robot;
}

Result<RobotRecord*> Fleet::known(std::string_view id, UtcTime now) {
  if (RobotRecord* robot = existing(id)) return robot;
  auto robot = insert(id);
  // All parts, for the disk may still have the robot as it was before it was forgotten.
  if (robot) changed(**robot, Changes::kNode | Changes::kAbilities | Changes::kState | Changes::kFaults, now);
  return robot;
}

RobotRecord* Fleet::existing(std::string_view id) {
  const auto at = robots_.find(id);
  return at == robots_.end() ? nullptr : &at->second;
}

const RobotRecord* Fleet::find(std::string_view id) const {
  const auto at = robots_.find(id);
  return at == robots_.end() ? nullptr : &at->second;
}

void Fleet::changed(const RobotRecord& robot, unsigned parts, UtcTime now) {
  if ((parts & Changes::kFaults) != 0) ++fault_changes_;
  retirement_of(robot) != nullptr ? void(retired_.insert(robot.id)) : void(retired_.erase(robot.id));
  const RobotNumber number = *index_.find(robot.id);
  if ((parts & ~unsigned{Changes::kState}) != 0) index_.set_words(number, words_of(robot));
  index_.set_measures(number, measures_of(robot));
  if ((parts & ~kToldAgain) != 0 && shares_[robot.id].of_robot.take(now)) changes_.at_once = true;
  changes_.robots[robot.id] = (changes_.robots[robot.id] | parts) & ~unsigned{Changes::kGone};
}

void Fleet::note(const RobotRecord& robot, std::string_view kind, std::string_view text, UtcTime now) {
  note(robot, kind, text, shares_[robot.id].of_robot, now);
}

void Fleet::note(const RobotRecord& robot, std::string_view kind, std::string_view text, WriteShare& share,
                 UtcTime now) {
  if (!share.take(now)) return share.leave_out();
  if (changes_.history.size() >= kMaxPendingHistory) drop_pending(robot.id);
  const std::uint64_t left_out = share.take_left_out();
  const std::string more = left_out == 0 ? "" : " (" + std::to_string(left_out) + " lines before it are left out)";
  changes_.history.push_back({now, robot.id, std::string(kind), cut_utf8(text, kMaxText - more.size()) + more});
}

/// The oldest of the robot that has the most.
void Fleet::drop_pending(const std::string& asking) {
  std::deque<HistoryEntry>& lines = changes_.history;
  const std::string most = gives_way(lines, asking, &HistoryEntry::robot);
  const auto oldest = std::ranges::find(lines, most, &HistoryEntry::robot);
  lines.erase(oldest == lines.end() ? lines.begin() : oldest);
  ++changes_.history_dropped;
}

Status Fleet::restore(RobotRecord robot) {
  if (existing(robot.id) != nullptr) return fail(Errc::duplicate, "robot '" + robot.id + "' is there already");
  const auto place = insert(robot.id);
  if (!place) return place.error();
  **place = std::move(robot);
  (*place)->reached = false;
  if (retirement_of(**place) != nullptr) retired_.insert((*place)->id);
  const RobotNumber number = *index_.find((*place)->id);
  index_.set_words(number, words_of(**place));
  index_.set_measures(number, measures_of(**place));
  return Done{};
}

/// A node that has just begun, or whose Hello was too long for it, has not told of its robot yet: that ends no fault,
/// and brings nobody back.
bool Fleet::take_profile(RobotRecord& robot, const NodeProfile& told, UtcTime now) {
  NodeProfile profile = cleaned(told);
  const NodeProfile& before = robot.profile.is;
  if (profile.robot.empty() && profile.out_of_use.empty()) profile.out_of_use = before.out_of_use;
  if (before == profile) return false;
  if (before.robot != profile.robot) note(robot, "connection", profile.robot + " " + profile.detail, now);
  if (before.fenced != profile.fenced) note(robot, profile.fenced ? "fenced" : "released", "", now);
  note_service(robot, before, profile, now);
  if (before.capabilities != profile.capabilities) note(robot, "profile", capabilities_of(profile), now);
  unsigned parts = same_abilities(before, profile) ? Changes::kNode : Changes::kNode | Changes::kAbilities;
  if (take_out_of_use(robot, before, profile, now)) parts |= Changes::kFaults;
  robot.profile = {profile, now};
  changed(robot, parts, now);
  return true;
}

bool Fleet::set_reached(RobotRecord& robot, bool reached, const std::string& reason, UtcTime now) {
  if (robot.reached == reached) return false;
  robot.reached = reached;
  note(robot, reached ? "joined" : "expired", reason, now);
  changed(robot, Changes::kNode, now);
  return true;
}

/// The own router has checked it. It is not on disk: the next table has it again.
bool Fleet::take_certificate(RobotRecord& robot, const SignedRecord& told) {
  auto certificate = decode<Certificate>(told.payload.bytes);
  if (!certificate || *certificate == robot.certificate) return false;
  robot.certificate = std::move(*certificate);
  return true;
}

Result<bool> Fleet::on_route(const Route& route, UtcTime now) {
  const auto robot = known(route.id, now);
  if (!robot) return robot.error();
  const bool has_other = take_certificate(**robot, route.certificate);
  const bool is_new = take_profile(**robot, route.profile, now) || has_other;
  const bool reached = route.state == "self" || route.state == "ONLINE";
  return set_reached(**robot, reached, reached ? "" : route.state, now) || is_new;
}

Status Fleet::on_joined(std::string_view id, UtcTime now) {
  const auto robot = known(id, now);
  if (!robot) return robot.error();
  set_reached(**robot, true, "", now);
  return Done{};
}

void Fleet::on_expired(std::string_view id, const std::string& reason, UtcTime now) {
  if (RobotRecord* robot = existing(id)) set_reached(*robot, false, reason, now);
}

bool Fleet::on_connection(std::string_view id, const RobotConnection& connection, UtcTime now) {
  RobotRecord* robot = existing(id);
  if (robot == nullptr) return false;
  NodeProfile profile = robot->profile.is;
  profile.robot = connection.state;
  profile.detail = connection.detail;
  take_profile(*robot, profile, now);
  return true;
}

bool Fleet::on_state(std::string_view id, const RobotState& state, UtcTime now) {
  RobotRecord* robot = existing(id);
  if (robot == nullptr) return false;
  bool all = true;
  for (const RobotValueTold& told : state.values) all = set_value(*robot, told.name, told.value, now) && all;
  changed(*robot, Changes::kState, now);
  return all;
}

bool Fleet::on_value(std::string_view id, const std::string& name, const std::string& value, UtcTime now) {
  RobotRecord* robot = existing(id);
  if (robot == nullptr || !set_value(*robot, name, value, now)) return false;
  changed(*robot, Changes::kState, now);
  return true;
}

bool Fleet::set_later_tasks(std::string_view id, std::uint32_t tasks) {
  RobotRecord* robot = existing(id);
  if (robot == nullptr) return false;
  if (robot->later_tasks == tasks) return true;
  robot->later_tasks = tasks;
  changed(*robot, Changes::kNode, {});  // the runs tell it again: nothing is written at once
  return true;
}

void Fleet::forget(std::string_view id, UtcTime now) {
  const auto at = robots_.find(id);
  if (at == robots_.end()) return;
  note(at->second, "forgotten", "", now);
  changes_.robots[at->first] = Changes::kGone;
  changes_.at_once = true;
  ++fault_changes_;
  retired_.erase(at->first);
  shares_.erase(at->first);
  index_.drop(id);
  robots_.erase(at);
}

}  // namespace trb::resilience
