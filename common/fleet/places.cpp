#include "common/fleet/places.hpp"

#include <cmath>

#include "common/base/ids.hpp"
#include "common/fleet/description_parts.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxPlaces = 1000;
constexpr double kFarthest = 1e6;  // metres: more is a wrong unit
constexpr double kTurn = 6.2832;   // radians: more is degrees

}  // namespace

Pose read_pose(const Value& json, const std::string& path, Need need, const FileFaults& faults) {
  ObjectReader reader(json, path, faults);
  const Range metres{-kFarthest, kFarthest};
  Pose pose;
  pose.x = reader.number("x", need, metres).value_or(0);
  pose.y = reader.number("y", need, metres).value_or(0);
  pose.z = reader.number("z", Need::optional, metres).value_or(0);
  pose.yaw = reader.number("yaw", Need::optional, Range{-1e6, 1e6}).value_or(0);
  if (std::abs(pose.yaw) > kTurn)
    reader.faults().add(reader.path("yaw"), "is more than a turn", "write it in radians: 90 degrees are 1.5708");
  reader.refuse_unknown_keys();
  return pose;
}

bool check_place_name(const std::string& name, const std::string& path, const FileFaults& faults) {
  const Status named = check_id("place", name);
  if (!named) faults.add(path, named.error().what, named.error().hint);
  return named.ok();
}

Places read_places(const Value& json, const std::string& file, ConfigFaults& faults) {
  const FileFaults sink(file, faults);
  ObjectReader reader(json, "", sink);
  Places places;
  if (const auto* members = reader.object("places", Need::required, kMaxPlaces)) {
    for (const auto& [name, pose] : *members) {
      const std::string path = "places." + name;
      if (check_place_name(name, path, sink)) places[name] = read_pose(pose, path, Need::required, sink);
    }
  }
  reader.refuse_unknown_keys();
  return places;
}

}  // namespace trb
