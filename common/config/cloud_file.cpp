#include "common/config/cloud_file.hpp"

#include <charconv>

#include "common/base/address.hpp"
#include "common/base/number_text.hpp"
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

/// "hall.example", "hall.example:443"
bool is_host_with_port(const std::string& name) {
  const std::size_t colon = name.find(':');
  if (colon == std::string::npos) return is_host_name(name);
  const auto port = parse_number<std::uint16_t>(std::string_view(name).substr(colon + 1));
  return is_host_name(std::string_view(name).substr(0, colon)) && port && *port > 0;
}

void take_names(std::vector<std::string> names, const FileFaults& faults, CloudSettings& out) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (is_host_with_port(names[i])) continue;
    faults.add(
        "names[" + std::to_string(i) + "]", "'" + names[i] + "' is no host name",
        R"(write small letters, digits, '-' and '.': "hall.example"; behind a proxy with its port: "hall.example:443")");
  }
  out.names = std::move(names);
}

void take_proxies(std::vector<std::string> proxies, const FileFaults& faults, CloudSettings& out) {
  for (std::size_t i = 0; i < proxies.size(); ++i) {
    const std::string& one = proxies[i];
    if (is_numeric_endpoint((one.find(':') == std::string::npos ? one : "[" + one + "]") + ":1")) continue;
    faults.add("proxies[" + std::to_string(i) + "]", "'" + one + "' is no numeric address",
               R"(write the address from which the proxy connects: "10.0.0.7")");
  }
  out.proxies = std::move(proxies);
}

constexpr std::string_view kUrl = "postgresql://";
constexpr const char* kDatabaseHint =
    "write postgresql://USER@HOST:PORT/NAME, or postgresql://USER@/NAME?host=/FOLDER for a socket on this machine; "
    "the password, if there is one, goes into keys/database.password";

bool is_word(std::string_view text) {
  constexpr std::string_view kGood = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
  return !text.empty() && text.size() <= 63 && text.find_first_not_of(kGood) == std::string_view::npos;
}

bool is_folder(std::string_view text) {
  return text.size() > 1 && text.size() < 90 && text.front() == '/' &&
         text.find_first_of("?&#%'\\ \t\r\n") == std::string_view::npos;
}

/// "HOST:PORT", "HOST", "[ADDRESS]:PORT"
bool take_host(std::string_view text, DatabaseAddress& out) {
  const bool is_bracketed = text.starts_with('[');
  const std::size_t end = is_bracketed ? text.find(']') : text.find(':');
  if (is_bracketed && end == std::string_view::npos) return false;
  out.host = is_bracketed ? text.substr(1, end - 1) : text.substr(0, end);
  std::string_view rest =
      end == std::string_view::npos ? std::string_view() : text.substr(is_bracketed ? end + 1 : end);
  if (!rest.empty()) {
    const auto port = rest.front() == ':' ? parse_number<std::uint16_t>(rest.substr(1)) : std::nullopt;
    if (!port || *port == 0) return false;
    out.port = *port;
  }
  if (is_bracketed) return is_numeric_endpoint("[" + out.host + "]:" + std::to_string(out.port));
  return is_host_name(out.host);
}

std::optional<DatabaseAddress> parse_database(std::string_view text) {
  if (!text.starts_with(kUrl)) return std::nullopt;
  text.remove_prefix(kUrl.size());
  const std::size_t at = text.find('@');
  if (at == std::string_view::npos) return std::nullopt;
  DatabaseAddress out;
  out.user = text.substr(0, at);
  const std::string_view rest = text.substr(at + 1);
  const std::size_t slash = rest.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  constexpr std::string_view kHost = "?host=";
  const std::size_t query = rest.find(kHost, slash);
  out.name = rest.substr(slash + 1, query == std::string_view::npos ? query : query - slash - 1);
  const bool is_socket = slash == 0 && query != std::string_view::npos;
  if (is_socket) out.host = rest.substr(query + kHost.size());
  const bool is_host =
      is_socket ? is_folder(out.host) : query == std::string_view::npos && take_host(rest.substr(0, slash), out);
  if (!is_host || !is_word(out.user) || !is_word(out.name)) return std::nullopt;
  return out;
}

/// What is wrong is not repeated: it may have a password.
void take_database(const std::string& text, const FileFaults& faults, CloudSettings& out) {
  out.database = parse_database(text);
  if (out.database) return;
  const std::string_view after = text.starts_with(kUrl) ? std::string_view(text).substr(kUrl.size()) : "";
  const std::string_view user = after.substr(0, std::min(after.find('@'), after.size()));
  if (user.size() < after.size() && user.find(':') != std::string_view::npos)
    return faults.add("database", "has a password", "put it into keys/database.password, mode 0600, and change it");
  faults.add("database", "is no address of a PostgreSQL database", kDatabaseHint);
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

bool DatabaseAddress::is_local() const {
  return host.starts_with('/') || host == "localhost" || host == "::1" || host.starts_with("127.");
}

std::string DatabaseAddress::text() const {
  if (host.starts_with('/')) return std::string(kUrl) + "/" + name + "?host=" + host;
  return std::string(kUrl) + in_url(host) + ":" + std::to_string(port) + "/" + name;
}

std::vector<std::string> CloudSettings::origins() const {
  const std::string end = port == 443 ? "" : ":" + std::to_string(port);
  std::vector<std::string> out{"https://localhost" + end, "https://127.0.0.1" + end};
  const bool own = address != "127.0.0.1" && address != "0.0.0.0" && address != "::";
  if (own) out.push_back("https://" + in_url(address) + end);
  for (const std::string& name : names) {
    const bool has_port = name.find(':') != std::string::npos;
    out.push_back("https://" + (name.ends_with(":443") ? name.substr(0, name.size() - 4) : name) +
                  (has_port ? "" : end));
  }
  return out;
}

CloudSettings read_cloud(const Value& json, const std::string& file, ConfigFaults& faults) {
  CloudSettings out;
  const FileFaults sink(file, faults);
  ObjectReader reader(json, "", sink);
  if (const auto listen = reader.text("listen", Need::optional)) take_listen(*listen, sink, out);
  take_names(reader.texts("names", Need::optional, kMaxNames), sink, out);
  take_proxies(reader.texts("proxies", Need::optional, kMaxNames), sink, out);
  if (const Value* history = reader.value("history", Need::optional)) take_history(*history, sink, out);
  if (const auto database = reader.text("database", Need::optional)) take_database(*database, sink, out);
  reader.refuse_unknown_keys();
  return out;
}

CloudSettings read_cloud_file(const std::string& node_dir, ConfigFaults& faults) {
  const auto json = load_json(node_dir + "/cloud.json", "", {"cloud.json", faults});
  return json ? read_cloud(*json, "cloud.json", faults) : CloudSettings{};
}

}  // namespace trb
