// What a client of the live stream shows that applies each frame, and halls of many robots for it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "services/cloud-gateway/core/live/test/hall.hpp"

namespace trb::gateway::test {

using Rows = std::vector<std::string>;

/// The rows of a client that applies each frame.
struct Shown {
  std::map<std::string, std::string> rows;  ///< by kind, node and name
  void take(const Frame& frame) {
    for (const SharedBlock& block : frame.blocks) {
      if (block->begins) rows.clear();
      for (const SharedBytes& bytes : block->rows) {
        const std::string key = bytes->substr(0, bytes->rfind(" v"));
        if (bytes->find("removed") != std::string::npos) {
          rows.erase(key);
        } else {
          rows[key] = *bytes;
        }
      }
    }
  }
};

inline std::vector<Route> many(int robots) {
  std::vector<Route> out;
  out.reserve(static_cast<std::size_t>(robots));
  for (int i = 0; i < robots; ++i) out.push_back(route("robot" + std::to_string(i)));
  return out;
}

inline void tell_all(Hall& hall, int value) {
  for (int i = 0; i < 1200; ++i) hall.tell("robot" + std::to_string(i), "battery", std::to_string(value));
}

}  // namespace trb::gateway::test
