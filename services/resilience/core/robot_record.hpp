// What is known about one robot: what its node reports, what it reports itself, and what is broken.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "proto/bodies/link.hpp"
#include "proto/bodies/robot.hpp"
#include "services/resilience/core/fleet_index.hpp"

namespace trb::resilience {

constexpr std::size_t kMaxValues = 64;  ///< names of values of one robot
constexpr std::size_t kMaxValueSize = 1024;
constexpr std::size_t kMaxFaults = 128;  ///< of one robot: those of its out_of_use, and lesser ones

/// A value with the time at which it was reported, so that a person sees how old it is.
template <class T>
struct Reported {
  T is{};
  UtcTime at;
  bool operator==(const Reported&) const = default;
};

/// A fault that the robot has reported and that has not ended.
struct Fault {
  std::string capability;  ///< empty: the whole robot
  Severity severity{};
  std::string text;
  UtcTime since;
  bool operator==(const Fault&) const = default;
};

/// In the hall's frame, m.
struct HallPoint {
  double x = 0;
  double y = 0;
  bool operator==(const HallPoint&) const = default;
};

struct RobotRecord {
  std::string id;
  Reported<NodeProfile> profile;
  Certificate certificate;  ///< in the router's table; serial 0: not told since the start
  bool reached = false;     ///< its node's route is up; false after a restart until the router reports it again
  std::map<std::string, Reported<std::string>, std::less<>>
      values;                     ///< by name, as the robot sent them: JSON, or words
  std::vector<Fault> faults;      ///< by capability, then severity; one of each
  std::uint32_t later_tasks = 0;  ///< that it still has in any run
};

/// CRITICAL and FATAL take a capability away; lesser faults are only shown.
[[nodiscard]] bool takes_away(const Fault& fault);

/// Is it a fault (not a retirement) that takes a capability away?
[[nodiscard]] bool is_standing(const OutOfUse& one);

/// The worst fault that keeps the robot from that capability; nullptr: none.
[[nodiscard]] const Fault* fault_of(const RobotRecord& robot, std::string_view capability);

/// The worst fault of exactly that capability (empty: of the whole robot) that takes it away; nullptr: none.
[[nodiscard]] const Fault* worst_fault(const RobotRecord& robot, std::string_view capability);

/// A person's order to take the robot out of service; nullptr: none.
[[nodiscard]] const OutOfUse* retirement_of(const RobotRecord& robot);
/// "is out of service: new wheels (by ann)"
[[nodiscard]] std::string retired_text(const OutOfUse& retirement);
/// Does the node's profile list that fault as standing? Then the node reports its end.
[[nodiscard]] bool is_reported_broken(const RobotRecord& robot, std::string_view capability);

/// Does the robot have it, no fault takes it away, and, if only plugged sensors give it, does one of them work?
[[nodiscard]] bool is_able(const RobotRecord& robot, std::string_view capability);

/// May it be given a task: reached, ONLINE, not fenced, in service, and without a CRITICAL or FATAL fault of the whole
/// robot?
[[nodiscard]] bool is_fit(const RobotRecord& robot);
/// Why it is not fit, for a person; empty if it is.
[[nodiscard]] std::string why_unfit(const RobotRecord& robot);

[[nodiscard]] const SkillInfo* find_skill(const RobotRecord& robot, std::string_view skill);

/// 100 for a robot without tasks, halved by one, a third with two, and so on (section 4: "100, lowered").
[[nodiscard]] double availability(const RobotRecord& robot);

/// The words of the index that are true of the robot.
inline constexpr std::string_view kFitWord = "fit";
[[nodiscard]] std::string capability_word(std::string_view capability);
[[nodiscard]] std::string skill_word(std::string_view skill);
[[nodiscard]] std::vector<std::string> words_of(const RobotRecord& robot);
[[nodiscard]] Measures measures_of(const RobotRecord& robot);

}  // namespace trb::resilience
