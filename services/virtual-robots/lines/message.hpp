#pragma once

#include <string>

namespace trb::virtual_robots::lines {

/** A message in words, whatever its encoding. The peer is its source or its target; empty: the own node. */
struct Message {
  std::string type;
  std::string subtype;
  std::string peer;
  std::string data;

  bool operator==(const Message&) const = default;
};

}  // namespace trb::virtual_robots::lines
