#include "common/drivers/udp-at/commands.hpp"

namespace trb::drivers {
namespace {

Status check_stop(const std::vector<AtLine>& lines) {
  if (lines.empty()) return Done{};
  const AtAction action = lines.front().action;
  const bool fits = action == AtAction::land || (action == AtAction::hover && lines.front().duration.empty());
  if (lines.size() == 1 && fits) return Done{};
  return fail(Errc::bad_value, "stops no drone: it must stand in the air or land",
              R"(write "hover" or "REF land"; cutting the motors is a command of its own, "REF emergency")");
}

}  // namespace

AtCommands read_at_commands(const VendorCommands& vendor, const Description&, const VendorFaults& faults) {
  AtCommands out;
  for (const auto& [subtype, words] : vendor.commands) {
    const std::string key = "commands." + subtype;
    auto lines = read_at_lines(words);
    if (!lines) faults.add(key, lines.error());
    if (const Status stops = lines && subtype == "stop" ? check_stop(*lines) : Status(Done{}); !stops) {
      faults.add(key, stops.error());
    }
    if (subtype == "release" && !words.empty()) {
      faults.add(key, "lifting a stop moves no drone", "leave its words empty");
    }
    if (lines) out.emplace(subtype, std::move(*lines));
  }
  return out;
}

}  // namespace trb::drivers
