#include "common/drivers/arcos/commands.hpp"

#include <algorithm>

namespace trb::drivers {
namespace {

bool stops(const std::vector<ArcosStep>& steps) {
  return std::ranges::any_of(steps, [](const ArcosStep& step) { return step.effect == ArcosEffect::stops; });
}

}  // namespace

ArcosCommands read_arcos_commands(const VendorCommands& vendor, const Description&, const VendorFaults& faults) {
  ArcosCommands out;
  for (const auto& [subtype, words] : vendor.commands) {
    auto steps = read_arcos_steps(words);
    if (!steps) {
      faults.add("commands." + subtype, steps.error());
      continue;
    }
    if (subtype == "stop" && !words.empty() && !stops(*steps)) {
      faults.add("commands." + subtype, "stops nothing", "use STOP, or E_STOP to brake as hard as the robot can");
    }
    out.commands.emplace(subtype, std::move(*steps));
  }
  out.values = read_part("values", vendor.values, faults, read_arcos_value);
  return out;
}

}  // namespace trb::drivers
