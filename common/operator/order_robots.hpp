// Orders to several robots at once: stop, release.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/operator/session.hpp"

namespace trb::op {

/// What became of an order to one robot.
struct RobotOrder {
  std::string robot;
  std::string state;  ///< "confirmed"; "sent": it may have arrived, but is not confirmed; "unreachable": it has not
  std::string text;   ///< why it is not confirmed; of a confirmed one, what that does not prove, as its node says it
  bool surely_not_told{};  ///< a router has refused it before it was delivered: the robot has not heard of it
};

/// Sends the body (Stop, Release) to all robots, then collects their answers until `wait` is over: a silent robot
/// delays no other's stop. `done` gets a row for each, in the same order.
void order_robots(Session& session, const std::vector<std::string>& robots, const Body& body, Duration wait,
                  std::function<void(std::vector<RobotOrder>)> done);

/// For an audit record (at most 96 bytes): "done" if all have confirmed, else how many have not, and which of them.
std::string outcome_in_words(const std::vector<RobotOrder>& orders);

}  // namespace trb::op
