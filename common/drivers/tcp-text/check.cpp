// What the transport tcp-text requires of commands.json.
#include "common/config/described_names.hpp"
#include "common/config/transports.hpp"
#include "common/drivers/place_items.hpp"
#include "common/drivers/tcp-text/monitored_names.hpp"
#include "common/drivers/tcp-text/reach.hpp"
#include "common/drivers/tcp-text/ur_rtde.hpp"
#include "common/drivers/tcp-text/urscript.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {

void read_tcp_text_keys(ObjectReader& vendor, VendorCommands& into);
void check_tcp_text(const NodeConfig& config, const FileFaults& faults);

namespace {

void check_monitor(const VendorCommands& vendor, const std::string& name, const FileFaults& faults) {
  if (vendor.monitor && vendor.monitor->protocol == "ar-navdata") {
    faults.add(name + ".monitor.protocol", "'ar-navdata' is not spoken beside tcp-text",
               R"(use "ur-primary", or the transport that the robot speaks)");
  }
  if (vendor.data_port && !vendor.monitor) {
    faults.add(name + ".rtde_port", "is beside a monitor, which tells the ends of programs, and there is none",
               R"(add "monitor": {"protocol": "ur-primary", "port": 30001}, or remove "rtde_port")");
  }
  if (vendor.requests.empty() || vendor.monitor) return;
  faults.add(name + ".requests", "are answered from the monitor, but no monitor is configured",
             R"(add "monitor": {"protocol": "ur-primary", "port": 30001}, or remove the requests)");
}

/// A stop that the controller does not know is noticed when a person needs it.
void check_stop(const VendorCommands& vendor, const std::string& name, const FileFaults& faults) {
  const auto stop = vendor.commands.find("stop");
  if (vendor.language != "urscript" || stop == vendor.commands.end() || stop->second.empty()) return;
  if (may_be_urscript(stop->second)) return;
  faults.add(name + ".commands.stop", "'" + stop->second + "' is neither a command of the controller nor a script",
             did_you_mean(stop->second, {"stop program", "halt"}, "write"));
}

/// A skill without a command would wait for the field channel, which this robot does not use.
void check_skills(const NodeConfig& config, const FileFaults& faults) {
  for (const Skill& skill : config.description.skills) {
    const bool watched = skill.end.kind == EndKind::state || skill.end.kind == EndKind::position;
    if (watched && !config.commands.monitor) {
      faults.add(config.framework + ".monitor", "is missing: the end of skill '" + skill.name + "' is seen by it",
                 R"(add "monitor": {"protocol": "ur-primary", "port": 30001}, or give the skill another end)");
    }
    check_skill_command(config, skill, faults);
    check_place_items(config, skill, config.commands.language == "urscript" ? Items::list : Items::any, faults);
  }
}

}  // namespace

void read_tcp_text_keys(ObjectReader& vendor, VendorCommands& into) {
  if (vendor.value("rtde_port", Need::optional) != nullptr) {
    into.data_port = static_cast<std::uint16_t>(vendor.integer("rtde_port", Need::optional, 1, 65535).value_or(0));
  }
  if (vendor.value(kRtdeRate, Need::optional) != nullptr && !into.data_port) {
    vendor.faults().add(vendor.path(kRtdeRate), "is the rate of RTDE, which is not used without \"rtde_port\"",
                        R"(add "rtde_port": 30004, or remove "rtde_hz")");
  }
  into.numbers[kRtdeRate] = vendor.number("rtde_hz", Need::optional, {1, kFastestRtde}).value_or(kUsualRtde);
  if (into.wrap.empty() || into.language == "urscript") return;
  vendor.faults().add(vendor.path("wrap"), "wraps URScript, but \"language\" is '" + into.language + "'",
                      "set \"language\" to \"urscript\", or remove \"wrap\"");
}

void check_tcp_text(const NodeConfig& config, const FileFaults& faults) {
  const VendorCommands& vendor = config.commands;
  const std::string& name = config.framework;
  require_port(config, faults, "30002 for a Universal Robot");
  check_words(vendor, name, faults);
  check_stop(vendor, name, faults);
  check_monitor(vendor, name, faults);
  check_monitored_names(config, faults);
  check_reach(config, faults);
  check_skills(config, faults);
}

}  // namespace trb::drivers
