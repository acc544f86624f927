// Batons and results that travelled in short form, as the handlers take them.
#pragma once

#include <optional>

#include "common/actor/inbound.hpp"
#include "services/scheduler/core/run_store.hpp"
#include "services/scheduler/core/step.hpp"

namespace trb::scheduler {

[[nodiscard]] bool is_short(const Body& body);

/// The same message in its long form. Nullopt: of a run that is not open here, which is counted (its sender sends it
/// again, in its long form), or malformed, which is refused.
std::optional<Inbound> lengthened(const Inbound& message, const RunStore& runs, Step step);

}  // namespace trb::scheduler
