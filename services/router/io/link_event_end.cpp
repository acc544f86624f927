#include "services/router/io/link_event_end.hpp"

namespace trb::router {

std::optional<LinkEnd> to_end(LinkEvent event) {
  switch (event) {
    case LinkEvent::connected:
    case LinkEvent::listening:
    case LinkEvent::accepted:
    case LinkEvent::accept_failed:
      return std::nullopt;
    case LinkEvent::failed:
      return LinkEnd::failed;
    case LinkEvent::disconnected:
      return LinkEnd::disconnected;
    case LinkEvent::refused_key:
      return LinkEnd::refused_key;
    case LinkEvent::no_curve:
      return LinkEnd::no_curve;
    case LinkEvent::wrong_server_key:
      return LinkEnd::wrong_server_key;
    case LinkEvent::protocol_error:
      return LinkEnd::protocol_error;
  }
  return LinkEnd::failed;
}

}  // namespace trb::router
