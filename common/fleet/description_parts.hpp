// The readers of a description's parts; only for description.cpp, its neighbours and common/config.
#pragma once

#include <string>
#include <vector>

#include "common/fleet/description.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb {

// Bounds of NodeProfile, which carries a description.
constexpr std::size_t kMaxCapabilities = 64;
constexpr std::size_t kMaxSkills = 128;
constexpr std::size_t kMaxParameters = 32;
constexpr std::size_t kMaxDrives = 4;
constexpr std::size_t kMaxRobotPlaces = 255;

/// {"x","y","z","yaw"}; `need` is for x and y.
Pose read_pose(const Value& json, const std::string& path, Need need, const FileFaults& faults);
bool check_place_name(const std::string& name, const std::string& path, const FileFaults& faults);

/// The key "capability" of a skill or a drive: one of the robot's.
std::string read_capability(ObjectReader& reader, const std::vector<std::string>& capabilities);
Parameter read_parameter(const std::string& name, const Value& json, const std::string& path, const FileFaults& faults);
Skill read_skill(const std::string& name, const Value& json, const std::vector<std::string>& capabilities,
                 const FileFaults& faults);
void read_drives(ObjectReader& reader, Description& description);
/// "faults" and "sensors".
std::vector<FaultRule> read_faults(ObjectReader& reader, const std::vector<std::string>& capabilities);
std::vector<std::string> read_sensors(ObjectReader& reader);

FieldChannel read_field_channel(const Value& json, const FileFaults& faults);

/// What the numeric encoding requires of the skills: a code for every name that is sent, and numbers as data.
void check_numeric(const Description& description, const FileFaults& faults);

/// A fault of places.json, to which `faults` leads, if they are more than NodeProfile::places takes: nobody would get
/// the robot's profile.
void check_place_names(const Description& description, const Places& places, const FileFaults& faults);

}  // namespace trb
