#include "common/drivers/polled_check.hpp"

#include "common/config/described_names.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {
namespace {

constexpr Range kHold{0, 5, false};

std::string with_name(std::string example, const std::string& name) {
  constexpr std::string_view kName = "NAME";
  const std::size_t at = example.find(kName);
  return at == std::string::npos ? example : example.replace(at, kName.size(), name);
}

}  // namespace

void read_hold_key(ObjectReader& vendor, VendorCommands& into) {
  if (const auto hold_s = vendor.number("hold_s", Need::optional, kHold)) into.numbers["hold_s"] = *hold_s;
}

void PolledCheck::check_foreign_keys() const {
  const VendorCommands& vendor = config_.commands;
  const std::string no_part = "is no part of " + examples_.transport + ", ";
  if (vendor.monitor) add("monitor", no_part + "whose values are asked for", "remove it");
  if (vendor.language != "plain") add("language", no_part + "which has " + examples_.has, "remove it");
}

void PolledCheck::check_names() const {
  for (const auto& [subtype, name] : config_.commands.requests) {
    if (!config_.commands.values.contains(name)) add_no_value("requests." + subtype, name, "");
  }
  for (const Skill& skill : config_.description.skills) check_skill(skill);
}

void PolledCheck::check_waited(const std::function<std::optional<Error>(const WaitedValue&)>& never) const {
  for (const WaitedValue& one : waited_values(config_)) {
    const auto why = never(one);
    if (!why) continue;
    add("values." + one.name,
        "is never " + text_of_wanted(one.wanted) + ", for which " + one.by + " of the description waits: " + why->what,
        why->hint);
  }
}

void PolledCheck::check_skill(const Skill& skill) const {
  const VendorCommands& vendor = config_.commands;
  const bool spoken = check_skill_command(config_, skill, faults_, examples_.command);
  const bool position = skill.end.kind == EndKind::position;
  if (!spoken || (!position && skill.end.kind != EndKind::state)) return;
  const std::string watched = skill.end.state.empty() ? "position" : skill.end.state;
  if (vendor.values.contains(watched) || vendor.requests.contains(watched)) return;
  add_no_value("values." + watched, watched, ": the end of skill '" + skill.name + "' is seen by it");
}

void PolledCheck::add_no_value(const std::string& key, const std::string& name, const std::string& why) const {
  const std::vector<std::string> known = names_in(config_.commands.values);
  const std::string example = R"(add "values": {")" + name + R"(": ")" + with_name(examples_.value, name) + R"("})";
  add(key, in_quotes(name) + " is no name of \"values\"" + why,
      known.empty() ? example : did_you_mean(name, known, "add it there, or use one of"));
}

}  // namespace trb::drivers
