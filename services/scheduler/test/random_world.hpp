// A scenario drawn by a seed, with all that decides how its run ends: what its robots do, what its sensors say; and
// what must not: the network, the order of things, processes that die.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "services/scheduler/test/fleet.hpp"
#include "services/simulator/world/dice.hpp"

namespace trb::scheduler::test {

/// A number from the environment, or the other one.
std::uint64_t from_environment(const char* name, std::uint64_t otherwise);

using world::Dice;

/// What a robot tells at the end of a task: nothing, a number, or a number by the name "n".
enum class Telling : std::uint8_t { nothing = 0, plain, named };

struct Sense {
  std::string node;
  std::string identity;
  bool is_text = false;
  double number = 0;
  std::string text;
  std::uint64_t bad_before = 0;  ///< so many readings that nobody may believe come first
};

struct World {
  Scenario scenario;
  std::vector<std::string> robots;
  std::string submitter;
  bool has_cloud = true;
  std::map<std::string, std::vector<TaskOutcome>> endings;  ///< a task's attempts in turn; the last one for ever
  std::map<std::string, Telling> tellings;
  std::map<std::string, Sense> senses;  ///< by the sensor's name
  /// Somebody at the cloud decides on whatever stands; so "spare" may come to do something, who is no member at first.
  bool decides = false;
  bool repeatable = false;                             ///< what was interrupted may be done again
  std::map<std::string, std::vector<Ruling>> rulings;  ///< on a task, each time that it stands; then it is skipped
  std::map<std::string, std::string> bindings;         ///< the robots of tasks that name none: chosen when they are due

  // What must make no difference.
  Weather weather;
  std::map<std::string, Duration> skill_times;
  std::map<std::string, std::size_t> crashes;  ///< robot -> at which of its commits its scheduler dies
  bool crash_after_sends = false;

  [[nodiscard]] TaskOutcome ending(const AttemptKey& key) const;
  /// A task's result: another one for other data or another attempt.
  [[nodiscard]] std::string told(const AttemptKey& key, const std::string& data) const;
  /// What is decided on a task that has stood so often before, and who has it from then on.
  [[nodiscard]] TaskRuling ruling(const std::string& task, std::size_t times, const std::string& robot,
                                  std::uint32_t next_attempt) const;
};

/// 1 to 200 tasks for 1 to 12 robots. In six of ten nothing happens for which a person has to be asked.
World random_world(std::uint64_t seed);

}  // namespace trb::scheduler::test
