// What of a robot can be driven by hand: a description's "drives".
#include <algorithm>
#include <array>

#include "common/base/ids.hpp"
#include "common/fleet/description_parts.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/fleet/placeholders.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxData = 4096;
/// m/s or rad/s; no robot of a hall is faster.
constexpr Range kLimit{0, 1000, true};
constexpr double kLargestFactor = 1e6;
constexpr std::array<std::string_view, 6> kFrameAxes = {"x", "y", "z", "roll", "pitch", "yaw"};

bool is_linear(std::string_view axis) {
  return axis == "x" || axis == "y" || axis == "z";
}

/// The names that the part's axes may have; empty: any.
std::vector<std::string> names_of_axes(DrivePart part) {
  if (part == DrivePart::joints) return {};
  if (part == DrivePart::belt) return {"x"};
  return {kFrameAxes.begin(), kFrameAxes.end()};
}

void check_name(const std::string& name, DrivePart part, const std::string& path, const FileFaults& faults) {
  const std::vector<std::string> known = names_of_axes(part);
  if (known.empty() && is_valid_word(name)) return;
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  faults.add(path, in_quotes(name) + " is no axis of '" + std::string(name_of(part)) + "'",
             known.empty() ? "start with a letter; then letters, digits, '_' or '-'"
                           : did_you_mean(name, known, "use some of"));
}

/// Either the limit alone, or an object with it.
DriveAxis read_axis(const std::string& name, ObjectReader& axes) {
  DriveAxis axis;
  axis.name = name;
  const Value* json = axes.value(name, Need::required);
  if (json == nullptr) return axis;
  if (!json->is_object()) {
    axis.limit = axes.number(name, Need::required, kLimit).value_or(0);
    return axis;
  }
  ObjectReader reader(*json, axes.path(name), axes.faults());
  axis.limit = reader.number("limit", Need::required, kLimit).value_or(0);
  axis.one_way = reader.boolean("one_way", Need::optional).value_or(false);
  axis.factor = reader.number("factor", Need::optional, {-kLargestFactor, kLargestFactor});
  if (axis.factor == 0.0) {
    reader.faults().add(reader.path("factor"), "is 0: the axis would never move",
                        "give the robot's number for 1 m/s or 1 rad/s");
  }
  reader.refuse_unknown_keys();
  return axis;
}

void read_axes(ObjectReader& reader, Drive& drive) {
  const auto* members = reader.object("axes", Need::required, kMaxDriveAxes);
  if (members == nullptr) return;
  if (members->empty()) reader.faults().add(reader.path("axes"), "is empty", R"(write for example {"x": 0.5})");
  const Value json{*members};
  ObjectReader axes(json, reader.path("axes"), reader.faults());
  for (const auto& [name, ignored] : *members) {
    check_name(name, drive.part, axes.path(name), reader.faults());
    DriveAxis axis = read_axis(name, axes);
    Parameter parameter;
    parameter.name = name;
    parameter.type = ParameterType::number;
    if (!axis.factor) parameter.unit = drive.part != DrivePart::joints && is_linear(name) ? "m/s" : "rad/s";
    drive.command.parameters.push_back(std::move(parameter));
    drive.axes.push_back(std::move(axis));
  }
}

void check_placeholders(const Skill& words, const std::string& path, const FileFaults& faults) {
  const Template data = parse_template(words.data);
  if (!data.well_formed) return faults.add(path, "has a bracket that is no placeholder", "use {AXIS}");
  std::vector<std::string> axes;
  for (const Parameter& axis : words.parameters) axes.push_back(axis.name);
  for (const Placeholder& used : data.placeholders) {
    const bool known = std::find(axes.begin(), axes.end(), used.name) != axes.end();
    if (known && used.coordinate.empty()) continue;
    const std::string whole = used.coordinate.empty() ? used.name : used.name + "." + used.coordinate;
    faults.add(path, "{" + whole + "} names no axis of it",
               axes.empty() ? "to stand takes no speeds: remove it" : did_you_mean(whole, axes, "use one of"));
  }
  for (const std::string& axis : axes) {
    const auto uses = [&](const Placeholder& used) { return used.name == axis; };
    if (std::any_of(data.placeholders.begin(), data.placeholders.end(), uses)) continue;
    faults.add(path, "axis '" + axis + "' is not sent", "add {" + axis + "}, or remove the axis");
  }
}

/// {"subtype", "data"}
void read_words(ObjectReader& drive, const char* key, Need need, Skill& words) {
  const Value* json = drive.value(key, need);
  if (json == nullptr) return;
  ObjectReader reader(*json, drive.path(key), drive.faults());
  words.subtype = reader.text("subtype", Need::required, kMaxIdSize).value_or("");
  words.data = reader.text("data", Need::optional, kMaxData).value_or("");
  reader.refuse_unknown_keys();
  if (!words.subtype.empty() && !is_valid_word(words.subtype)) {
    drive.faults().add(reader.path("subtype"), in_quotes(words.subtype) + " is no subtype",
                       "start with a letter; then letters, digits, '_' or '-'");
  }
  if (words.subtype == "stop" || words.subtype == "release") {
    drive.faults().add(reader.path("subtype"), in_quotes(words.subtype) + " fences the robot, or ends that",
                       "give it a subtype of its own");
  }
  check_placeholders(words, reader.path("data"), drive.faults());
}

Drive read_drive(const Value& json, const std::string& path, const Description& description, const FileFaults& faults) {
  ObjectReader reader(json, path, faults);
  Drive drive;
  const auto part = reader.one_of<DrivePart>("part", Need::required);
  drive.part = part.value_or(DrivePart::joints);
  drive.command.name = "drive " + std::string(name_of(drive.part));
  drive.command.capability = read_capability(reader, description.capabilities);
  read_axes(reader, drive);
  read_words(reader, "command", Need::required, drive.command);
  if (reader.value("stand", Need::optional) != nullptr) {
    Skill stand;
    stand.name = drive.command.name;
    stand.capability = drive.command.capability;
    read_words(reader, "stand", Need::optional, stand);
    drive.stand = std::move(stand);
  }
  reader.refuse_unknown_keys();
  if (part && description.find_drive(*part) != nullptr) {
    faults.add(reader.path("part"), in_quotes(name_of(*part)) + " occurs twice", "keep one of them");
  }
  return drive;
}

}  // namespace

DriveInfo Drive::info() const {
  DriveInfo info;
  info.part = part;
  for (const DriveAxis& axis : axes) {
    info.axes.push_back(axis.name);
    info.limits.push_back(axis.limit);
  }
  return info;
}

void read_drives(ObjectReader& reader, Description& description) {
  const auto* items = reader.list("drives", Need::optional, kMaxDrives);
  if (items == nullptr) return;
  for (std::size_t i = 0; i < items->size(); ++i) {
    const std::string path = reader.path("drives[" + std::to_string(i) + "]");
    description.drives.push_back(read_drive((*items)[i], path, description, reader.faults()));
  }
}

}  // namespace trb
