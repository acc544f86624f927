// What an event of a dialled connection's monitor means for its link.
#pragma once

#include <optional>

#include "common/transport/monitor.hpp"
#include "services/router/core/link_end.hpp"

namespace trb::router {

/// How the dialled connection ended, if the event is an end.
std::optional<LinkEnd> to_end(LinkEvent event);

}  // namespace trb::router
