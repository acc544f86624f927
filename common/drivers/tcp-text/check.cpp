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

constexpr const char* kAddMonitor = R"(add "monitor": {"protocol": "ur-primary", "port": 30001})";

/// What would give the robot a monitor, or how to do without; only a Universal Robot can have one.
std::string monitor_or(const VendorCommands& vendor, const std::string& other) {
  if (vendor.language == "urscript") return std::string(kAddMonitor) + ", or " + other;
  return "tcp-text reads nothing but a Universal Robot's monitor: " + other;
}

void check_monitor(const VendorCommands& vendor, const std::string& name, const FileFaults& faults) {
  if (vendor.monitor && vendor.monitor->protocol == "ar-navdata") {
    faults.add(name + ".monitor.protocol", "'ar-navdata' is not spoken beside tcp-text",
               R"(use "ur-primary", or the transport that the robot speaks)");
  }
  if (vendor.data_port && !vendor.monitor) {
    faults.add(name + ".rtde_port", "is beside a monitor, which tells the ends of programs, and there is none",
               std::string(kAddMonitor) + R"(, or remove "rtde_port")");
  }
  if (vendor.requests.empty() || vendor.monitor) return;
  faults.add(name + ".requests", "are answered from the monitor, but no monitor is configured",
             monitor_or(vendor, "remove the requests"));
}

/// A stop that the controller does not know is noticed when a person needs it.
void check_stop(const VendorCommands& vendor, const std::string& name, const FileFaults& faults) {
  const auto stop = vendor.commands.find("stop");
  if (vendor.language != "urscript" || stop == vendor.commands.end() || stop->second.empty()) return;
  if (may_be_urscript(stop->second)) return;
  faults.add(name + ".commands.stop", "'" + stop->second + "' is neither a command of the controller nor a script",
             did_you_mean(stop->second, {"stop program", "halt"}, "write"));
}

/// Only the end of a named program is told, and only by the monitor.
void check_acknowledgement(const NodeConfig& config, const Skill& skill, const FileFaults& faults) {
  const VendorCommands& vendor = config.commands;
  const auto command = vendor.commands.find(skill.subtype);
  if (skill.end.kind != EndKind::acknowledgement || command == vendor.commands.end()) return;
  const bool direct = is_interface_command(command->second);
  if (!vendor.wrap.empty() && vendor.monitor && !direct) return;
  const bool may_be_told = vendor.language == "urscript" && !direct;
  faults.add(
      config.framework + ".commands." + skill.subtype,
      "has no end that the robot tells, and skill '" + skill.name + "' waits for one",
      may_be_told
          ? R"(add "wrap": "urscript-program" and "monitor": {"protocol": "ur-primary", "port": 30001}, or give )"
            R"(the skill an end of kind "time")"
          : R"(give the skill an end of kind )" + std::string(vendor.monitor ? R"("state" or )" : "") + R"("time")");
}

/// A skill without a command would wait for the field channel, which this robot does not use.
void check_skills(const NodeConfig& config, const FileFaults& faults) {
  for (const Skill& skill : config.description.skills) {
    const bool watched = skill.end.kind == EndKind::state || skill.end.kind == EndKind::position;
    if (watched && !config.commands.monitor) {
      faults.add(config.framework + ".monitor", "is missing: the end of skill '" + skill.name + "' is seen by it",
                 monitor_or(config.commands, R"(give the skill an end of kind "time")"));
    }
    check_acknowledgement(config, skill, faults);
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
