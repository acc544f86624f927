#include "services/router/core/metrics_text.hpp"

#include <string_view>
#include <utility>
#include <vector>

namespace trb::router {
namespace {

using Labels = std::vector<std::pair<std::string_view, std::string>>;

/// Within a label's quotes a backslash, a quote and a new line have to be escaped.
std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '\\' || c == '"') out += '\\';
    out += c == '\n' ? "\\n" : std::string(1, c);
  }
  return out + "\"";
}

class Text {
 public:
  void family(std::string_view name, std::string_view type, std::string_view help) {
    name_ = "trb_node_" + std::string(name);
    out_ += "# HELP " + name_ + " " + std::string(help) + "\n# TYPE " + name_ + " " + std::string(type) + "\n";
  }
  void sample(const Labels& labels, std::uint64_t value) {
    out_ += name_;
    std::string_view before = "{";
    for (const auto& [label, text] : labels) {
      out_ += std::string(before) + std::string(label) + "=" + quoted(text);
      before = ",";
    }
    out_ += (labels.empty() ? " " : "} ") + std::to_string(value) + "\n";
  }
  [[nodiscard]] std::string take() && { return std::move(out_); }

 private:
  std::string out_;
  std::string name_;
};

void add_node(const NodeMetrics& is, Text& out) {
  out.family("info", "gauge", "Always 1; which node, and its version.");
  out.sample({{"node", is.own.id}, {"role", std::string(name_of(is.own.role))}, {"version", is.own.version}}, 1);
  out.family("boot", "gauge", "The boot number: it rises with each start of the router.");
  out.sample({}, is.own.boot);
  out.family("clock_verified", "gauge", "0: the clock is behind what the fleet has signed.");
  out.sample({}, is.own.clock == "verified" ? 1 : 0);
  out.family("certificate_ends_seconds", "gauge", "When the node's certificate ends, UTC.");
  out.sample({}, static_cast<std::uint64_t>(is.certificate_ends_s));
  if (!is.disk_free_bytes) return;
  out.family("disk_free_bytes", "gauge", "Room on the disk of the node's folder, without what is kept for root.");
  out.sample({}, *is.disk_free_bytes);
}

void add_services(const NodeMetrics& is, Text& out) {
  out.family("service_up", "gauge", "1: it is up; 0: silent or down.");
  for (const ServiceEntry& one : is.services.services)
    out.sample({{"service", one.service}}, one.state == "up" ? 1 : 0);
  out.family("service_notes", "gauge", "1: trb service list and trb doctor have something to tell of it.");
  for (const ServiceEntry& one : is.services.services) out.sample({{"service", one.service}}, one.note.empty() ? 0 : 1);
}

void add_robot(const NodeMetrics& is, Text& out) {
  if (is.own.role != Role::robot) return;
  out.family("robot_online", "gauge", "1: the robot is connected.");
  out.sample({}, is.own.profile.robot == "ONLINE" ? 1 : 0);
  out.family("robot_fenced", "gauge", "1: it was stopped, and not released.");
  out.sample({}, is.own.profile.fenced ? 1 : 0);
  out.family("robot_out_of_use", "gauge", "What faults and people keep out of use.");
  out.sample({}, is.own.profile.out_of_use.size());
}

void add_peers(const NodeMetrics& is, Text& out) {
  out.family("peers", "gauge", "Other nodes of the fleet, by how they are reached.");
  for (const char* state : {"ONLINE", "CONNECTION_BROKEN", "OFFLINE"}) {
    const auto found = is.rows.find(state);
    out.sample({{"state", state}}, found == is.rows.end() ? 0 : found->second);
  }
}

void add_events(const NodeMetrics& is, Text& out) {
  out.family("events_total", "counter", "The router's counters, as trb service counters router has them.");
  for (const Counter& one : is.counters.values) {
    const std::size_t dot = one.name.find('.');
    const std::string about = dot == std::string::npos ? "" : one.name.substr(dot + 1);
    out.sample({{"event", one.name.substr(0, dot)}, {"about", about}}, one.value);
  }
}

}  // namespace

bool take_page(const RouteTable& page, NodeMetrics& is) {
  for (const Route& row : page.routes) {
    if (row.state == "self") {
      is.own = row;
    } else {
      ++is.rows[row.state];
    }
  }
  return !page.more || page.routes.empty();
}

std::string metrics_text(const NodeMetrics& is) {
  Text out;
  add_node(is, out);
  add_services(is, out);
  add_robot(is, out);
  add_peers(is, out);
  add_events(is, out);
  return std::move(out).take();
}

}  // namespace trb::router
