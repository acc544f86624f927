// Fleet: faults, as robots and their nodes' profiles report them.
#include <algorithm>
#include <tuple>

#include "common/base/ids.hpp"
#include "proto/value.hpp"
#include "services/resilience/core/fleet.hpp"

namespace trb::resilience {
namespace {

auto rank(const Fault& fault) {
  return std::tie(fault.capability, fault.severity);
}

/// Makes room for one more: the oldest of the least severe is removed.
void make_room(std::vector<Fault>& faults) {
  if (faults.size() < kMaxFaults) return;
  faults.erase(std::min_element(faults.begin(), faults.end(), [](const Fault& a, const Fault& b) {
    return std::tie(a.severity, a.since) < std::tie(b.severity, b.since);
  }));
}

/// A fault that is reported again keeps its first time.
void add_fault(std::vector<Fault>& faults, Fault fault) {
  const auto by_rank = [](const Fault& a, const Fault& b) { return rank(a) < rank(b); };
  const auto at = std::lower_bound(faults.begin(), faults.end(), fault, by_rank);
  if (at != faults.end() && rank(*at) == rank(fault)) {
    at->text = std::move(fault.text);
    return;
  }
  make_room(faults);
  faults.insert(std::lower_bound(faults.begin(), faults.end(), fault, by_rank), std::move(fault));
}

std::string words_of_fault(Severity severity, const std::string& capability, const std::string& text) {
  return std::string(name_of(severity)) + " " + (capability.empty() ? "" : capability + ": ") + text;
}

const OutOfUse* standing_in(const NodeProfile& profile, std::string_view capability) {
  const auto at = std::ranges::find_if(
      profile.out_of_use, [&](const OutOfUse& one) { return is_standing(one) && one.capability == capability; });
  return at == profile.out_of_use.end() ? nullptr : &*at;
}

}  // namespace

bool Fleet::on_fault(std::string_view id, const RobotFault& told, UtcTime now) {
  if (told.capability.size() > kMaxIdSize) return false;
  if (told.ended) return on_fault_ended(id, told, now);
  const auto place = known(id, now);
  if (!place) return false;
  RobotRecord* robot = *place;
  Fault fault{told.capability, told.severity, cut_utf8(told.text, kMaxValueSize), now};
  // A robot may report it a thousand times a second: it need not be written again.
  const auto same = [&](const Fault& one) { return rank(one) == rank(fault) && one.text == fault.text; };
  if (std::ranges::any_of(robot->faults, same)) return true;
  note(*robot, "fault", words_of_fault(fault.severity, fault.capability, fault.text), now);
  add_fault(robot->faults, std::move(fault));
  changed(*robot, Changes::kFaults, now);
  return true;
}

bool Fleet::end_faults(std::string_view id, std::string_view capability, const std::string& why, UtcTime now) {
  RobotRecord* robot = existing(id);
  if (robot == nullptr) return false;
  const auto ended = std::erase_if(robot->faults, [&](const Fault& fault) { return fault.capability == capability; });
  if (ended == 0) return false;
  note(*robot, "fault_ended", (capability.empty() ? "" : std::string(capability) + ": ") + why, now);
  changed(*robot, Changes::kFaults, now);
  return true;
}

/// The robot's report ends its own faults of that severity and below, but not one that was found by something else.
bool Fleet::on_fault_ended(std::string_view id, const RobotFault& told, UtcTime now) {
  RobotRecord* robot = existing(id);
  if (robot == nullptr) return false;
  const OutOfUse* standing = standing_in(robot->profile.is, told.capability);
  if (standing != nullptr && !standing->by.empty()) return true;
  const auto ended = std::erase_if(robot->faults, [&](const Fault& fault) {
    return fault.capability == told.capability && fault.severity <= told.severity;
  });
  if (ended == 0) return true;
  const std::string of = told.capability.empty() ? "" : told.capability + ": ";
  note(*robot, "fault_ended", of + (told.text.empty() ? "the robot says so" : told.text), now);
  changed(*robot, Changes::kFaults, now);
  return true;
}

/// The profile is authoritative: what it no longer lists is over, what is new in it stands. A fault of the whole robot
/// is also reported for each of its capabilities: those end with it. A fault that it lists as before may have been
/// ended by the robot a moment ago.
bool Fleet::take_out_of_use(RobotRecord& robot, const NodeProfile& before, const NodeProfile& profile, UtcTime now) {
  bool some = false;
  for (const OutOfUse& old : before.out_of_use) {
    const OutOfUse* is = standing_in(profile, old.capability);
    if (!is_standing(old) || (is != nullptr && is->severity == old.severity)) continue;
    const auto ended = std::erase_if(robot.faults, [&](const Fault& fault) {
      const bool with_it = is == nullptr && old.capability.empty() && standing_in(profile, fault.capability) == nullptr;
      return takes_away(fault) && (fault.capability == old.capability || with_it);
    });
    if (ended == 0) continue;
    some = true;
    if (is == nullptr) {
      note(robot, "fault_ended", (old.capability.empty() ? "" : old.capability + ": ") + "its node says so", now);
    }
  }
  for (const OutOfUse& one : profile.out_of_use) {
    if (!is_standing(one) || std::ranges::count(before.out_of_use, one) != 0) continue;
    Fault fault{one.capability, one.severity, one.text, now};
    if (std::ranges::any_of(robot.faults, [&](const Fault& known) { return rank(known) == rank(fault); })) continue;
    note(robot, "fault", words_of_fault(one.severity, one.capability, one.text), now);
    add_fault(robot.faults, std::move(fault));
    some = true;
  }
  return some;
}

/// Notes `retired` and `returned` in the history, of a robot that talks too much as well.
void Fleet::note_service(const RobotRecord& robot, const NodeProfile& before, const NodeProfile& profile, UtcTime now) {
  const auto was = std::ranges::find_if(before.out_of_use, &OutOfUse::retired);
  const auto is = std::ranges::find_if(profile.out_of_use, &OutOfUse::retired);
  const bool was_retired = was != before.out_of_use.end();
  const bool is_retired = is != profile.out_of_use.end();
  if (is_retired && !(was_retired && *was == *is)) {
    const std::string by = is->by.empty() ? "" : " (by " + is->by + ")";
    note(robot, "retired", is->text + by, shares_[robot.id].of_people, now);
  }
  if (was_retired && !is_retired) note(robot, "returned", "", shares_[robot.id].of_people, now);
}

}  // namespace trb::resilience
