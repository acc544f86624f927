// Are two nodes of a fleet in memory linked by one link, the same on both sides?
#pragma once

#include <doctest/doctest.h>

#include <string>

#include "services/router/test/test_fleet.hpp"

namespace trb::router {

inline void check_linked(TestFleet& fleet, const std::string& a, const std::string& b) {
  CAPTURE(a);
  CAPTURE(b);
  CHECK(fleet.at(a).link_to(b) != 0);
  CHECK(fleet.at(a).link_to(b) == fleet.at(b).link_to(a));
}

}  // namespace trb::router
