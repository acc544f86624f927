// What an event of a dialled connection's monitor means for its link.
#pragma once

#include <optional>

#include "common/transport/monitor.hpp"
#include "services/router/core/link_end_reason.hpp"

namespace trb::router {

/// How the dialled connection ended, if the event is an end.
std::optional<LinkEndReason> to_end_reason(LinkEvent event);

}  // namespace trb::router
