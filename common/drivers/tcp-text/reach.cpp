#include "common/drivers/tcp-text/reach.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "common/drivers/tcp-text/urscript.hpp"
#include "common/drivers/text/number_text.hpp"
#include "common/drivers/text/vendor_template.hpp"

namespace trb::drivers {
namespace {

using Place = std::array<double, 3>;

/// What a maker calls reach is less than the flange's farthest way: so much an outstretched hand adds, over the ground
/// and overhead. A pose beyond is certainly out of reach; the controller decides about the rest.
constexpr double kAside = 1.2;
constexpr double kAnyway = 1.5;

bool is_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

void skip(std::string_view& text, std::string_view what) {
  text.remove_prefix(std::min(text.find_first_not_of(what), text.size()));
}

std::optional<double> take_number(std::string_view& text) {
  skip(text, " \t");
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || !std::isfinite(number)) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  skip(text, " \t");
  if (text.empty() || (text.front() != ',' && text.front() != ']')) return std::nullopt;
  text.remove_prefix(1);
  return number;
}

std::optional<Place> take_place(std::string_view text) {
  Place place{};
  for (double& number : place) {
    const auto taken = take_number(text);
    if (!taken) return std::nullopt;
    number = *taken;
  }
  return place;
}

std::string text_of(const Place& place) {
  return "p[" + number_text(place[0]) + ", " + number_text(place[1]) + ", " + number_text(place[2]) + ", …]";
}

std::optional<double> reach_of(const Description& description) {
  for (const NamedNumber& number : description.numbers) {
    if (number.name == "reach" && number.unit == "m" && number.value > 0) return number.value;
  }
  return std::nullopt;
}

class ReachCheck {
 public:
  ReachCheck(const NodeConfig& config, double reach, const FileFaults& faults)
      : config_(config), reach_(reach), faults_(faults) {}

  void check_commands() {
    for (const auto& [subtype, text] : config_.commands.commands) check(text, subtype, "");
  }

  void check_skill(const Skill& skill) {
    const auto command = config_.commands.commands.find(skill.subtype);
    if (command == config_.commands.commands.end()) return;
    check_filled(command->second, skill, skill.data);
    for (const Parameter& parameter : skill.parameters) {
      if (skill.data != "{" + parameter.name + "}") continue;
      for (const std::string& data : data_of(parameter)) check_filled(command->second, skill, data);
    }
  }

 private:
  /// What a parameter may be, as far as the description says it: its preset, and the robot's own places.
  [[nodiscard]] std::vector<std::string> data_of(const Parameter& parameter) const {
    std::vector<std::string> out;
    if (parameter.preset && parameter.preset->is_list()) out.push_back(dump_json(*parameter.preset));
    for (const std::string& name : parameter.one_of) {
      const auto place = config_.description.places.find(name);
      if (place != config_.description.places.end()) out.push_back(dump_json(place->second));
    }
    return out;
  }

  void check_filled(const std::string& text, const Skill& skill, const std::string& data) {
    const auto filled = VendorTemplate(text).fill(data, urscript_literal);
    if (filled) check(*filled, skill.subtype, " of skill '" + skill.name + "'");
  }

  void check(std::string_view script, const std::string& subtype, const std::string& whose) {
    for (const Place& place : poses_in(script)) {
      const double aside = std::hypot(place[0], place[1]);
      const double far = std::hypot(aside, place[2]);
      if (aside <= kAside * reach_ && far <= kAnyway * reach_) continue;
      if (std::find(told_.begin(), told_.end(), std::pair(subtype, place)) != told_.end()) continue;
      told_.emplace_back(subtype, place);
      const std::string what = "the pose " + text_of(place) + whose + " is " +
                               number_text(std::round(far * 100) / 100) +
                               " m away from the robot's foot, and its reach is " + number_text(reach_) + " m";
      faults_.add(config_.framework + ".commands." + subtype, what,
                  "give metres in the frame of its foot, or correct \"reach\" in the description's numbers");
    }
  }

  const NodeConfig& config_;
  double reach_;
  const FileFaults& faults_;
  std::vector<std::pair<std::string, Place>> told_;  ///< a pose is named once for a command
};

}  // namespace

std::vector<std::array<double, 3>> poses_in(std::string_view script) {
  std::vector<Place> places;
  for (std::size_t at = script.find("p["); at != std::string_view::npos; at = script.find("p[", at + 1)) {
    if (at > 0 && is_word(script[at - 1])) continue;
    if (const auto place = take_place(script.substr(at + 2))) places.push_back(*place);
  }
  return places;
}

std::optional<Error> out_of_reach(std::string_view script, const std::optional<UrReach>& reach) {
  if (!reach || script.find("set_tcp") != std::string_view::npos) return std::nullopt;
  if (script.find("move") == std::string_view::npos) return std::nullopt;
  for (const Place& place : poses_in(script)) {
    const double far = std::hypot(place[0], place[1], place[2] - reach->shoulder_height);
    if (far <= reach->length) continue;
    return fail(Errc::bad_value,
                "the pose " + text_of(place) + " is " + number_text(std::round(far * 100) / 100) +
                    " m away from the arm's shoulder, and it reaches " +
                    number_text(std::round(reach->length * 100) / 100) + " m at most",
                "give metres in the frame of the arm's foot");
  }
  return std::nullopt;
}

void check_reach(const NodeConfig& config, const FileFaults& faults) {
  const auto reach = reach_of(config.description);
  if (!reach || config.commands.language != "urscript") return;
  ReachCheck check(config, *reach, faults);
  check.check_commands();
  for (const Skill& skill : config.description.skills) check.check_skill(skill);
}

}  // namespace trb::drivers
