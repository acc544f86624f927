// In what unit a robot reports its charge, as far as its profile shows.
#pragma once

#include <optional>
#include <string_view>

#include "proto/bodies/link.hpp"

namespace trb {

/// Subtypes of the requests for a robot's charge, as commands.json names them for every robot.
inline constexpr std::string_view kChargeRequests[] = {"state_of_charge", "battery"};
inline constexpr std::string_view kPositionRequest = "position";

/// What 100 % is in a robot's `battery`; nothing: its unit is not known, or it does not measure charge.
std::optional<double> full_battery(const NodeProfile& profile);
/// The one of kChargeRequests whose answer tells the charge.
std::string_view charge_request(const NodeProfile& profile);
/// It drives or flies; any other robot stands where its description says.
bool moves(const NodeProfile& profile);

}  // namespace trb
