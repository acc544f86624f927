#include "common/config/metrics_file.hpp"

#include "common/base/address.hpp"
#include "common/base/number_text.hpp"
#include "common/config/json_file.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb {
namespace {

constexpr const char* kHint =
    R"(write "127.0.0.1:9464": an address of this machine alone; for others, let this machine's Prometheus be asked)";

std::optional<MetricsAddress> address_of(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (!is_numeric_endpoint(text) || !text.starts_with("127.")) return std::nullopt;
  const auto port = parse_number<std::uint16_t>(std::string_view(text).substr(colon + 1));
  if (!port || *port == 0) return std::nullopt;
  return MetricsAddress{text.substr(0, colon), *port};
}

}  // namespace

std::optional<MetricsAddress> read_metrics(const Value& json, const std::string& file, ConfigFaults& faults) {
  const FileFaults sink(file, faults);
  ObjectReader reader(json, "", sink);
  const auto listen = reader.text("listen", Need::required);
  const auto out = listen ? address_of(*listen) : std::nullopt;
  if (listen && !out) sink.add("listen", "'" + *listen + "' is no 127.x.y.z:PORT", kHint);
  reader.refuse_unknown_keys();
  return out;
}

std::optional<MetricsAddress> read_metrics_file(const std::string& node_dir, ConfigFaults& faults) {
  const auto json = load_json(node_dir + "/metrics.json", "", {"metrics.json", faults});
  return json ? read_metrics(*json, "metrics.json", faults) : std::nullopt;
}

}  // namespace trb
