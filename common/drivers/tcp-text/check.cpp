// What the transport tcp-text requires of commands.json.
#include "common/config/transports.hpp"
#include "common/drivers/check_names.hpp"

namespace trb::drivers {

void read_tcp_text_keys(ObjectReader& vendor, VendorCommands& into);
void check_tcp_text(const NodeConfig& config, const FileFaults& faults);

namespace {

void check_monitor(const VendorCommands& vendor, const std::string& name, const FileFaults& faults) {
  if (vendor.monitor && vendor.monitor->protocol == "ar-navdata") {
    faults.add(name + ".monitor.protocol", "'ar-navdata' is not spoken beside tcp-text",
               R"(use "ur-primary", or the transport that the robot speaks)");
  }
  if (vendor.requests.empty() || vendor.monitor) return;
  faults.add(name + ".requests", "are answered from the monitor, but no monitor is configured",
             R"(add "monitor": {"protocol": "ur-primary", "port": 30001}, or remove the requests)");
}

/// A skill without a command would wait for the field channel, which this robot does not use.
void check_skills(const NodeConfig& config, const FileFaults& faults) {
  for (const Skill& skill : config.description.skills) {
    const bool watched = skill.end.kind == EndKind::state || skill.end.kind == EndKind::position;
    if (watched && !config.commands.monitor) {
      faults.add(config.framework + ".monitor", "is missing: the end of skill '" + skill.name + "' is seen by it",
                 R"(add "monitor": {"protocol": "ur-primary", "port": 30001}, or give the skill another end)");
    }
    check_command(config, skill, faults);
  }
}

}  // namespace

void read_tcp_text_keys(ObjectReader& vendor, VendorCommands& into) {
  if (into.wrap.empty() || into.language == "urscript") return;
  vendor.faults().add(vendor.path("wrap"), "wraps URScript, but \"language\" is '" + into.language + "'",
                      "set \"language\" to \"urscript\", or remove \"wrap\"");
}

void check_tcp_text(const NodeConfig& config, const FileFaults& faults) {
  const VendorCommands& vendor = config.commands;
  const std::string& name = config.framework;
  require_port(config, faults, "30002 for a Universal Robot");
  check_words(vendor, name, faults);
  check_monitor(vendor, name, faults);
  check_skills(config, faults);
}

}  // namespace trb::drivers
