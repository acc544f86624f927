// NODE_DIR/metrics.json: where Prometheus asks this node; without the file nobody is told anything.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/base/config_fault.hpp"
#include "proto/value.hpp"

namespace trb {

struct MetricsAddress {
  std::string address;  ///< of this machine alone: 127.x.y.z
  std::uint16_t port = 0;
};

/// "listen": "127.0.0.1:9464". Empty: it cannot be used, and the faults say why.
std::optional<MetricsAddress> read_metrics(const Value& json, const std::string& file, ConfigFaults& faults);
/// Empty, too, if there is no such file.
std::optional<MetricsAddress> read_metrics_file(const std::string& node_dir, ConfigFaults& faults);

}  // namespace trb
