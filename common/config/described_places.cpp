#include "common/config/described_places.hpp"

#include <algorithm>
#include <vector>

#include "common/fleet/did_you_mean.hpp"
#include "common/fleet/object_reader.hpp"
#include "common/fleet/placeholders.hpp"

namespace trb {
namespace {

class PlacesCheck {
 public:
  PlacesCheck(const Description& description, const Places& hall, const FileFaults& faults, std::string hall_file)
      : own_(description.places), hall_(hall), faults_(faults), hall_file_(std::move(hall_file)) {}

  void check(const Skill& skill, const Parameter& parameter) const {
    std::vector<std::string> names = parameter.one_of;
    const bool preset = parameter.preset && parameter.preset->is_text();
    if (preset && names.empty()) names.push_back(parameter.preset->text());
    const std::vector<Placeholder> used = parse_template(skill.data).placeholders;
    const auto is_used = [&](bool whole) {
      return std::any_of(used.begin(), used.end(), [&](const Placeholder& one) {
        return one.name == parameter.name && one.coordinate.empty() == whole;
      });
    };
    const std::string key = "skills." + skill.name + ".parameters." + parameter.name;
    for (const std::string& name : names) {
      if (is_used(false) ? hall_.contains(name) : hall_.contains(name) || own_.contains(name)) continue;
      add(key, name, is_used(false), is_used(true));
    }
  }

 private:
  void add(const std::string& key, const std::string& name, bool by_pose, bool whole) const {
    const std::vector<std::string> in_hall = names_in(hall_);
    if (by_pose) {
      return faults_.add(
          key, "the coordinates of " + in_quotes(name) + " are sent, and " + hall_file_ + " has no such place",
          did_you_mean(name, in_hall, "add it there with its pose, or use one of"));
    }
    // What the robot gets as a whole is its own term for the place; without one, it gets the place's name.
    const std::vector<std::string> own = names_in(own_);
    const std::string otherwise = whole ? R"(add it to "places" of the description, with the robot's own term for it)"
                                        : "add it to " + hall_file_;
    faults_.add(key,
                in_quotes(name) + " is no place: neither \"places\" of the description nor " + hall_file_ + " has it",
                did_you_mean(name, whole ? own : in_hall,
                             (whole ? own : in_hall).empty() ? otherwise : otherwise + ", or use one of"));
  }

  const std::map<std::string, Value>& own_;
  const Places& hall_;
  const FileFaults& faults_;
  std::string hall_file_;
};

}  // namespace

void check_described_places(const Description& description, const Places& hall, const std::string& file,
                            const std::string& hall_file, ConfigFaults& faults) {
  const FileFaults sink(file, faults);
  const PlacesCheck check(description, hall, sink, hall_file);
  for (const Skill& skill : description.skills) {
    for (const Parameter& parameter : skill.parameters) {
      if (parameter.type == ParameterType::place) check.check(skill, parameter);
    }
  }
}

}  // namespace trb
