// What a run comes to, by a plain sequential reading of config/scenarios/README.md: one task after the other, no
// robots, no messages, nothing of the code under test.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "services/scheduler/test/random_world.hpp"

namespace trb::scheduler::test {

struct Command {
  std::string robot;
  std::string data;
  bool operator==(const Command&) const = default;
};

struct Ended {
  bool reached = false;  ///< all before it are final
  TaskState state{};
  bool goes_on = false;                       ///< SKIPPED, and what follows goes on
  std::map<std::uint32_t, Command> commands;  ///< by attempt
  std::uint32_t attempt = 1;                  ///< that it ended with, or would have
  bool holds = false;                         ///< somebody has to decide before the run can go on
  bool aborts = false;

  [[nodiscard]] bool is_final() const { return state == TaskState::finished || state == TaskState::skipped; }
};

/// For each task what becomes of it, if nothing stops its robot before.
std::vector<Ended> interpret(const World& world);

}  // namespace trb::scheduler::test
