// Where a node's bus is: node.json's "bus".

#include "common/base/files.hpp"
#include "common/base/number_text.hpp"
#include "common/config/interfaces.hpp"
#include "common/config/readers.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/security/bus_keys.hpp"

namespace trb {
namespace {

constexpr std::string_view kTcp = "tcp://";
constexpr int kLastBusPort = 65534;  // the tap takes the next one

bool is_everywhere(const std::string& host) {
  return host == "0.0.0.0" || host.find_first_not_of("0:") == std::string::npos;
}

}  // namespace

Endpoint split_endpoint(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos || colon == 0) return {};
  const auto port = parse_number<std::uint16_t>(std::string_view(address).substr(colon + 1)).value_or(0);
  if (port == 0) return {};
  std::string host = address.substr(0, colon);
  const bool brackets = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (brackets) host = host.substr(1, host.size() - 2);
  if (brackets ? !is_ipv6(host) : !is_ipv4(host)) return {};
  return {host, port};
}

std::string read_bus_key(ObjectReader& reader) {
  const auto text = reader.text("bus", Need::optional, 80);
  if (!text || *text == "ipc") return "";
  const char* hint = R"(use "ipc", or an address of the router's machine: "tcp://10.0.0.1:46000")";
  if (!text->starts_with(kTcp)) {
    reader.faults().add("bus", in_quotes(*text) + " is neither \"ipc\" nor tcp://ADDRESS:PORT", hint);
    return "";
  }
  std::string address = text->substr(kTcp.size());
  const Endpoint at = split_endpoint(address);
  if (at.host.empty() || at.port > kLastBusPort) {
    reader.faults().add("bus", in_quotes(*text) + " names no address and port below 65535", hint);
  } else if (is_everywhere(at.host)) {
    reader.faults().add("bus", in_quotes(*text) + " tells the services no address to go to", hint);
  } else {
    return address;
  }
  return "";
}

Result<std::string> read_bus(const std::string& node_dir) {
  auto text = read_file(node_dir + "/node.json");
  if (!text) {
    const bool missing = text.error().code == Errc::missing;
    return fail(text.error().code, text.error().what, missing ? "name a node's folder" : text.error().hint);
  }
  auto json = parse_json(*text);
  if (!json) return fail(json.error().code, node_dir + "/node.json: " + json.error().what, json.error().hint);
  ConfigFaults faults;
  ObjectReader reader(*json, "", FileFaults("node.json", faults));
  std::string bus = read_bus_key(reader);
  if (!faults.empty()) return fail(Errc::bad_value, to_text(faults), faults.front().hint);
  return bus;
}

std::vector<std::string> bus_names(const NodeConfig& config) {
  std::vector<std::string> names = config.services;
  names.emplace_back(kBusProbe);
  return names;
}

}  // namespace trb
