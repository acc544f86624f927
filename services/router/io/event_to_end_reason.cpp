#include "services/router/io/event_to_end_reason.hpp"

namespace trb::router {

std::optional<LinkEndReason> to_end_reason(LinkEvent event) {
  switch (event) {
    case LinkEvent::connected:
    case LinkEvent::reached:
    case LinkEvent::listening:
    case LinkEvent::accepted:
    case LinkEvent::accept_failed:
      return std::nullopt;
    case LinkEvent::failed:
      return LinkEndReason::failed;
    case LinkEvent::disconnected:
      return LinkEndReason::disconnected;
    case LinkEvent::refused_key:
      return LinkEndReason::refused_key;
    case LinkEvent::no_curve:
      return LinkEndReason::no_curve;
    case LinkEvent::wrong_server_key:
      return LinkEndReason::wrong_server_key;
    case LinkEvent::protocol_error:
      return LinkEndReason::protocol_error;
  }
  return LinkEndReason::failed;
}

}  // namespace trb::router
