#include "common/operator/phases.hpp"

#include <optional>

namespace trb::op {
namespace {

std::optional<CostPhase> phase_of_counter(std::string_view name) {
  constexpr std::string_view kSent = "sent.";
  if (name.starts_with(kSent)) return phase_of(name.substr(kSent.size()));
  if (name == "from_robot.ready") return CostPhase::boot;
  if (name.starts_with("to_robot.") || name.starts_with("from_robot.")) return CostPhase::task;
  return std::nullopt;
}

}  // namespace

std::map<CostPhase, std::uint64_t> count_phases(const Counters& counters) {
  std::map<CostPhase, std::uint64_t> out;
  for (const Counter& counter : counters.values) {
    if (const auto phase = phase_of_counter(counter.name)) out[*phase] += counter.value;
  }
  return out;
}

}  // namespace trb::op
