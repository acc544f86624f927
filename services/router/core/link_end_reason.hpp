// How a connection that this node has dialled ends.
#pragma once

#include <array>
#include <string_view>

namespace trb::router {

enum class LinkEndReason : unsigned char {
  failed,
  disconnected,
  refused_key,
  no_curve,
  wrong_server_key,
  protocol_error
};
constexpr auto enum_names(LinkEndReason) {
  return std::array<std::string_view, 6>{"failed",   "disconnected",     "refused_key",
                                         "no_curve", "wrong_server_key", "protocol_error"};
}

}  // namespace trb::router
