// What Prometheus is told of a node: its services, peers and counters, as text.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "proto/bodies/bus.hpp"
#include "proto/bodies/link.hpp"

namespace trb::router {

struct NodeMetrics {
  std::int64_t certificate_ends_s = 0;             ///< UTC
  std::optional<std::uint64_t> disk_free_bytes{};  ///< of the disk of the node's folder
  ServiceTable services;                           ///< the router first
  std::map<std::string, std::size_t> rows;         ///< how many other nodes are ONLINE, OFFLINE ...
  Route own;                                       ///< this node's row of the table
  Counters counters;
};

/// Adds a page of the table; true if it was the last.
bool take_page(const RouteTable& page, NodeMetrics& is);

/// The text exposition, version 0.0.4: the families trb_node_*. The counter "refused.no_service" is
/// trb_node_events_total{event="refused",about="no_service"}.
std::string metrics_text(const NodeMetrics& is);

}  // namespace trb::router
