// What a client of the live stream says and hears of driving, as JSON.
#pragma once

#include <string>

#include "proto/value.hpp"
#include "services/cloud-gateway/core/live/drives.hpp"

namespace trb::gateway {

/// {"drive": ROBOT, "part": "base", "speeds": [0.2], "sequence": 1, "take": false}. Errors: missing, bad_value,
/// too_large; the text names the member.
Result<DriveWord> read_drive_word(const Value& word);
/// The robot of {"ask_for": ROBOT} or {"let_go": ROBOT}. The same errors.
Result<std::string> read_robot_word(const Value& word, std::string_view name);
/// {"drive": {"robot", "sequence", "state", "round_trip_s", "error"}}
std::string json_drive_answer(const DriveAnswer& answer);

}  // namespace trb::gateway
