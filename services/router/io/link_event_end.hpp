// What an event of a dialled connection's monitor means for its link.
#pragma once

#include <optional>

#include "common/transport/monitor.hpp"
#include "services/router/core/link_end.hpp"

namespace trb::router {

/// How a dialled connection has ended, if the event is its end.
std::optional<LinkEnd> to_end(LinkEvent event);

}  // namespace trb::router
