#include "common/drivers/place_items.hpp"

#include <algorithm>
#include <optional>
#include <string_view>

#include "common/drivers/text/vendor_template.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {
namespace {

/// Six joints or a pose: these functions of URScript take no other list.
constexpr std::size_t kSix = 6;
constexpr std::string_view kOfSix[] = {"movej({data}",  "movel({data}",  "movep({data}",
                                       "servoj({data}", "speedj({data}", "speedl({data}"};

class ItemsCheck {
 public:
  ItemsCheck(const NodeConfig& config, const Skill& skill, Items items, const FileFaults& faults)
      : config_(config), skill_(skill), items_(items), faults_(faults) {
    const std::string& words = config.commands.commands.at(skill.subtype);
    wanted_ = VendorTemplate(words).items();
    const auto takes_six = [&](std::string_view text) { return words.find(text) != std::string::npos; };
    if (wanted_ != 0 || config.commands.language != "urscript" || !std::ranges::any_of(kOfSix, takes_six)) return;
    wanted_ = kSix;
    items_ = Items::exact;
  }

  void check(const Parameter& parameter) const {
    if (wanted_ == 0) return;
    if (parameter.type == ParameterType::numbers && parameter.count && !fits(*parameter.count)) {
      add("parameter " + in_quotes(parameter.name) + " of skill " + in_quotes(skill_.name) + " has " +
              std::to_string(*parameter.count),
          "write \"count\": " + std::to_string(wanted_) + " there in the description, or correct the command");
    }
    if (parameter.type != ParameterType::place) return;
    for (const std::string& place : parameter.one_of) check_place(place);
    const bool preset = parameter.preset && parameter.preset->is_text();
    if (preset && parameter.one_of.empty()) check_place(parameter.preset->text());
  }

 private:
  [[nodiscard]] bool fits(std::size_t count) const {
    return items_ == Items::exact ? count == wanted_ : count >= wanted_;
  }

  void check_place(const std::string& place) const {
    const auto own = config_.description.places.find(place);
    const bool known = own != config_.description.places.end();
    // One that is nowhere is a fault of the description's own: common/config/described_places.
    if (!known && !config_.places.empty() && !config_.places.contains(place)) return;
    const bool is_list = known && own->second.is_list();
    if (is_list ? fits(own->second.list().size()) : items_ == Items::any) return;
    const std::string sent = "place " + in_quotes(place) + ", which skill " + in_quotes(skill_.name) + " may send, ";
    const std::string cure = std::to_string(wanted_) + " numbers";
    if (is_list) {
      return add(sent + "has " + std::to_string(own->second.list().size()),
                 "write places." + place + " of the description with " + cure);
    }
    add(sent + (known ? "is no list" : "has no numbers of the robot's own"),
        (known ? "write places." + place + " of the description as a list of " + cure
               : "add " + in_quotes(place) + " to \"places\" of the description, with " + cure +
                     ", or take it out of the skill's one_of"));
  }

  void add(const std::string& what, const std::string& hint) const {
    faults_.add(config_.framework + ".commands." + skill_.subtype,
                "takes " + std::to_string(wanted_) + " items, and " + what, hint);
  }

  const NodeConfig& config_;
  const Skill& skill_;
  Items items_;
  const FileFaults& faults_;
  std::size_t wanted_ = 0;
};

}  // namespace

void check_place_items(const NodeConfig& config, const Skill& skill, Items items, const FileFaults& faults) {
  if (!config.commands.commands.contains(skill.subtype)) return;
  const ItemsCheck check(config, skill, items, faults);
  for (const Parameter& parameter : skill.parameters) {
    if (skill.data == "{" + parameter.name + "}") check.check(parameter);
  }
}

}  // namespace trb::drivers
