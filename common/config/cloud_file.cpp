#include "common/config/cloud_file.hpp"

#include <charconv>

#include "common/base/address.hpp"
#include "common/config/json_file.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxNames = 16;
constexpr std::int64_t kMaxDays = 3650;
constexpr std::int64_t kMaxMegabytes = 1'000'000;
constexpr const char* kListenHint = R"(write "127.0.0.1:8443", or "0.0.0.0:8443" for every interface)";

void take_listen(const std::string& text, const FileFaults& faults, CloudSettings& out) {
  const std::size_t colon = text.rfind(':');
  if (!is_numeric_endpoint(text)) return faults.add("listen", "'" + text + "' is no HOST:PORT", kListenHint);
  out.address = text.substr(0, colon);
  if (out.address.starts_with('[')) out.address = out.address.substr(1, out.address.size() - 2);
  std::from_chars(text.data() + colon + 1, text.data() + text.size(), out.port);
}

/// RFC 1123: letters, digits and hyphens, parts divided by dots.
bool is_host_name(std::string_view name) {
  constexpr std::string_view kGood = "abcdefghijklmnopqrstuvwxyz0123456789-.";
  return !name.empty() && name.size() <= 253 && name.find_first_not_of(kGood) == std::string_view::npos &&
         name.front() != '-' && name.front() != '.' && name.back() != '-' && name.find("..") == std::string_view::npos;
}

void take_names(std::vector<std::string> names, const FileFaults& faults, CloudSettings& out) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (is_host_name(names[i])) continue;
    faults.add("names[" + std::to_string(i) + "]", "'" + names[i] + "' is no host name",
               R"(write small letters, digits, '-' and '.': "hall.example")");
  }
  out.names = std::move(names);
}

void take_history(const Value& json, const FileFaults& faults, CloudSettings& out) {
  ObjectReader reader(json, "history", faults);
  if (const auto days = reader.integer("days", Need::optional, 1, kMaxDays))
    out.history_days = static_cast<std::uint32_t>(*days);
  if (const auto size = reader.integer("megabytes", Need::optional, 1, kMaxMegabytes))
    out.history_mb = static_cast<std::uint32_t>(*size);
  reader.refuse_unknown_keys();
}

/// As it stands in a URL.
std::string in_url(const std::string& host) {
  return host.find(':') == std::string::npos ? host : "[" + host + "]";
}

}  // namespace

std::vector<std::string> CloudSettings::origins() const {
  const std::string end = port == 443 ? "" : ":" + std::to_string(port);
  std::vector<std::string> out{"https://localhost" + end, "https://127.0.0.1" + end};
  const bool own = address != "127.0.0.1" && address != "0.0.0.0" && address != "::";
  if (own) out.push_back("https://" + in_url(address) + end);
  for (const std::string& name : names) out.push_back("https://" + name + end);
  return out;
}

CloudSettings read_cloud(const Value& json, const std::string& file, ConfigFaults& faults) {
  CloudSettings out;
  const FileFaults sink(file, faults);
  ObjectReader reader(json, "", sink);
  if (const auto listen = reader.text("listen", Need::optional)) take_listen(*listen, sink, out);
  take_names(reader.texts("names", Need::optional, kMaxNames), sink, out);
  if (const Value* history = reader.value("history", Need::optional)) take_history(*history, sink, out);
  reader.refuse_unknown_keys();
  return out;
}

CloudSettings read_cloud_file(const std::string& node_dir, ConfigFaults& faults) {
  const auto json = load_json(node_dir + "/cloud.json", "", {"cloud.json", faults});
  return json ? read_cloud(*json, "cloud.json", faults) : CloudSettings{};
}

}  // namespace trb
