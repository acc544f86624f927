// Drives a robot by hand: the same speeds for a while, as a page sends them.
#pragma once

#include <string>
#include <vector>

#include "common/operator/session.hpp"

namespace trb::op {

struct DriveWish {
  std::string robot;
  DrivePart part{};
  std::vector<double> speeds;
  Duration lasts{};
  bool take = false;
  std::string by;  ///< the person
};

struct DriveReport {
  std::size_t sent = 0;             ///< messages, with the last one
  std::vector<double> round_trips;  ///< of those that were answered, in ms
};

/// How often speeds are sent: the robot's node lets it stand after 250 ms without any.
constexpr Duration kDrivePeriod = std::chrono::milliseconds(100);

/// Sends the speeds every 100 ms, and at the end that the person lets go. Errors: a Nack's, which ends it; those of
/// Session::send; timeout: it is not known whether the robot's node has heard the end (it lets the robot stand anyway).
void drive_robot(Session& session, const DriveWish& wish, const Callback<DriveReport>& done);

}  // namespace trb::op
