// What the history tells of a robot.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "services/resilience/test/fixture.hpp"

namespace trb::resilience::test {

/// The kinds of what the history has of the robot, the oldest first.
inline std::vector<std::string> kinds(Fixture& fixture, const std::string& robot) {
  std::vector<std::string> out;
  const Body answer = fixture.ask(HistoryListRequest{robot, 500});
  for (const RobotEvent& one : get<HistoryTable>(answer).events) out.push_back(one.kind);
  std::reverse(out.begin(), out.end());
  return out;
}

inline std::size_t count_of(const std::vector<std::string>& words, const std::string& word) {
  return static_cast<std::size_t>(std::count(words.begin(), words.end(), word));
}

}  // namespace trb::resilience::test
