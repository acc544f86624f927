#include "common/fleet/description.hpp"

#include <algorithm>
#include <limits>

#include "common/base/ids.hpp"
#include "common/fleet/description_parts.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxOwnNumbers = 64;
constexpr std::size_t kMaxUnit = 16;
constexpr double kMillimetres = 1000;
constexpr double kDegrees = 57.29577951308232;

RobotFrame read_frame(const Value& json, const FileFaults& faults) {
  ObjectReader reader(json, "frame", faults);
  RobotFrame frame;
  if (reader.choice("length_unit", Need::optional, {"m", "mm"}) == 1U) frame.length = kMillimetres;
  if (reader.choice("angle_unit", Need::optional, {"rad", "deg"}) == 1U) frame.angle = kDegrees;
  if (const Value* origin = reader.value("origin", Need::optional)) {
    frame.origin = read_pose(*origin, "frame.origin", Need::optional, faults);
  }
  reader.refuse_unknown_keys();
  return frame;
}

std::vector<std::string> read_capabilities(ObjectReader& reader) {
  std::vector<std::string> capabilities = reader.texts("capabilities", Need::required, kMaxCapabilities);
  for (const std::string& capability : capabilities) {
    if (is_valid_word(capability)) continue;
    reader.faults().add("capabilities", in_quotes(capability) + " is no capability",
                        "use a letter, then letters, digits, '_' or '-', 64 at most");
  }
  return capabilities;
}

void read_own_places(ObjectReader& reader, Description& description) {
  const auto* members = reader.object("places", Need::optional, kMaxRobotPlaces);
  if (members == nullptr) return;
  for (const auto& [name, words] : *members) {
    if (check_place_name(name, "places." + name, reader.faults())) description.places[name] = words;
  }
}

void read_numbers(ObjectReader& reader, Description& description) {
  const auto* members = reader.object("numbers", Need::optional, kMaxOwnNumbers);
  if (members == nullptr) return;
  for (const auto& [name, json] : *members) {
    const std::string path = "numbers." + name;
    if (!is_valid_word(name)) {
      reader.faults().add(path, in_quotes(name) + " is no name",
                          "start with a letter; then letters, digits, '_' or '-'");
    }
    ObjectReader number(json, path, reader.faults());
    const auto value = number.number("value", Need::required);
    const auto unit = number.text("unit", Need::optional, kMaxUnit);
    number.refuse_unknown_keys();
    description.numbers.push_back({name, value.value_or(0), unit.value_or("")});
  }
}

void read_skills(ObjectReader& reader, Description& description) {
  const auto* members = reader.object("skills", Need::required, kMaxSkills);
  if (members == nullptr) return;
  for (const auto& [name, json] : *members) {
    description.skills.push_back(read_skill(name, json, description.capabilities, reader.faults()));
  }
}

ParameterInfo info_of(const Parameter& parameter) {
  ParameterInfo info{parameter.name, std::string(name_of(parameter.type)), parameter.required, parameter.unit};
  constexpr double kOpen = std::numeric_limits<double>::max();
  if (parameter.minimum || parameter.maximum) {
    info.range = {parameter.minimum.value_or(-kOpen), parameter.maximum.value_or(kOpen)};
  }
  info.one_of = parameter.one_of;
  info.count = static_cast<std::uint32_t>(parameter.count.value_or(0));
  return info;
}

}  // namespace

const Skill* Description::find_skill(std::string_view name) const {
  const auto at = std::find_if(skills.begin(), skills.end(), [&](const Skill& skill) { return skill.name == name; });
  return at == skills.end() ? nullptr : &*at;
}

const Drive* Description::find_drive(DrivePart part) const {
  const auto at = std::find_if(drives.begin(), drives.end(), [&](const Drive& drive) { return drive.part == part; });
  return at == drives.end() ? nullptr : &*at;
}

Description read_description(const Value& json, const std::string& file, ConfigFaults& faults) {
  const FileFaults sink(file, faults);
  ObjectReader reader(json, "", sink);
  Description description;
  description.maker = reader.text("maker", Need::required, 64).value_or("");
  description.model = reader.text("model", Need::required, 64).value_or("");
  description.capabilities = read_capabilities(reader);
  if (const Value* frame = reader.value("frame", Need::optional)) description.frame = read_frame(*frame, sink);
  read_own_places(reader, description);
  if (const Value* channel = reader.value("field_channel", Need::optional)) {
    description.has_field_channel = true;
    description.field_channel = read_field_channel(*channel, sink);
  }
  read_skills(reader, description);
  read_drives(reader, description);
  description.faults = read_faults(reader, description.capabilities);
  description.sensors = read_sensors(reader);
  read_numbers(reader, description);
  check_numeric(description, sink);
  reader.refuse_unknown_keys();
  return description;
}

std::vector<SkillInfo> skill_infos(const Description& description) {
  std::vector<SkillInfo> infos;
  for (const Skill& skill : description.skills) {
    SkillInfo info{skill.name, skill.capability, {}, skill.repeatable, skill.timeout_s};
    std::transform(skill.parameters.begin(), skill.parameters.end(), std::back_inserter(info.parameters), info_of);
    infos.push_back(std::move(info));
  }
  return infos;
}

std::vector<std::string> place_names(const Description& description, const Places& places) {
  std::vector<std::string> names;
  for (const auto& [name, ignored] : description.places) names.push_back(name);
  for (const auto& [name, ignored] : places) {
    if (!description.places.contains(name)) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

void check_place_names(const Description& description, const Places& places, const FileFaults& faults) {
  const std::size_t count = place_names(description, places).size();
  if (count <= kMaxRobotPlaces) return;
  faults.add("places",
             "has " + std::to_string(count) + " places with the robot's own, and a robot's profile takes " +
                 std::to_string(kMaxRobotPlaces),
             "leave out those that this robot is not sent to");
}

}  // namespace trb
