#include "services/cloud-gateway/core/live/node_rows.hpp"

#include <set>
#include <utility>

#include "common/base/ids.hpp"
#include "proto/body.hpp"

namespace trb::gateway {
namespace {

Live live_of_state(const std::string& state) {
  if (state == "self" || state == "ONLINE") return Live::live;
  return state == "CONNECTION_BROKEN" ? Live::late : Live::not_heard;
}

NodeRow row_of(const Route& route) {
  const auto certificate = decode<Certificate>(route.certificate.payload.bytes);  // the router has checked it
  const UtcTime ends{certificate ? certificate->not_after : 0};
  return {route.role, route.state, route.address, route.version, route.clock, route.via, {}, route.boot, ends};
}

std::set<std::string> ids_of(const RouteTable& table) {
  std::set<std::string> out;
  for (const Route& route : table.routes) out.insert(route.id);
  return out;
}

}  // namespace

void NodeRows::take(RouteTable table, Now now, Outbox& out) {
  remove_missing(table, now);
  for (Route& route : table.routes) take_route(std::move(route), now, out);
}

/// A node that joined between two pages may be missing in both, so recently seen nodes stay.
void NodeRows::remove_missing(const RouteTable& table, Now now) {
  const std::set<std::string> there = ids_of(table);
  for (auto at = nodes_.begin(); at != nodes_.end();) {
    if (there.contains(at->first) || now.mono - at->second.heard < kForget) {
      ++at;
      continue;
    }
    for (const RowKey& key : book_.keys_of(at->first)) book_.remove(key, now);
    at = nodes_.erase(at);
  }
}

NodeRows::Known* NodeRows::know(const std::string& node, Now now, Outbox& out) {
  const auto at = nodes_.find(node);
  if (at == nodes_.end() && (nodes_.size() == kMaxNodes || !is_valid_id(node))) {
    out.count(nodes_.size() == kMaxNodes ? "refused.too_many_nodes" : "dropped.no_id");
    return nullptr;
  }
  Known& known = at == nodes_.end() ? nodes_[node] : at->second;
  known.heard = now.mono;
  return &known;
}

void NodeRows::take_route(Route route, Now now, Outbox& out) {
  Known* known = know(route.id, now, out);
  if (known == nullptr) return;
  known->boot = route.boot;
  const Live live = live_of_state(route.state);
  set_live(route.id, live, now);
  if (!book_.put({RowKind::node, route.id, {}}, row_of(route), live, now)) out.count("refused.node_budget");
  take_profile(route.id, std::move(route.profile), now, out);
  forget_lesser_faults(route.id, now, out);
}

/// The table may be older than the robot's last message: only a changed profile counts.
void NodeRows::take_profile(const std::string& node, NodeProfile profile, Now now, Outbox& out) {
  const RowKey key{RowKind::profile, node, {}};
  const RowKey robot{RowKind::robot, node, {}};
  const Live live = nodes_[node].live;
  const Row* before = book_.find(key);
  if (before != nullptr && same_content(before->content, profile)) {
    for (const RowKey& one : book_.keys_of(node)) {
      if (one.kind != RowKind::reading && one.kind != RowKind::teleop) book_.confirm(one, live, now);
    }
    return;
  }
  if (!profile.robot.empty() || book_.find(robot) != nullptr) take_report(node, profile, now, out);
  take(node, profile.plugged, now, out);
  if (!book_.put(key, std::move(profile), live, now)) out.count("refused.node_budget");
}

void NodeRows::forget_lesser_faults(const std::string& node, Now now, Outbox& out) {
  const RowKey key{RowKind::robot, node, {}};
  const Row* row = book_.find(key);
  if (row == nullptr) return;
  RobotRow robot = std::get<RobotRow>(row->content);
  if (!forget_lesser(robot, now.utc)) return;
  if (!book_.put(key, std::move(robot), nodes_[node].live, now)) out.count("refused.node_budget");
}

void NodeRows::take(const std::string& node, const std::vector<SensorInfo>& sensors, Now now, Outbox& out) {
  const Known* known = know(node, now, out);
  if (known == nullptr) return;
  std::set<std::string> there;
  for (const SensorInfo& sensor : sensors) {
    if (there.size() < kMaxSensors) there.insert(sensor.name);
  }
  for (const RowKey& key : book_.keys_of(node)) {
    const bool of_sensor = key.kind == RowKind::sensor || key.kind == RowKind::reading;
    if (of_sensor && !there.contains(key.name)) book_.remove(key, now);
  }
  for (const SensorInfo& sensor : sensors) {
    if (!there.contains(sensor.name)) continue;
    if (!book_.put({RowKind::sensor, node, sensor.name}, sensor, known->live, now)) out.count("refused.node_budget");
  }
}

/// Its robot is shown as live only after a new message about it.
void NodeRows::take(const PeerJoined& joined, Now now, Outbox& out) {
  Known* known = know(joined.id, now, out);
  if (known == nullptr || joined.boot < known->boot) return;
  known->boot = joined.boot;
  known->live = Live::live;
  const RowKey key{RowKind::node, joined.id, {}};
  NodeRow row;
  if (const Row* before = book_.find(key)) row = std::get<NodeRow>(before->content);
  row.state = "ONLINE";
  row.boot = joined.boot;
  row.reason.clear();
  book_.put(key, std::move(row), Live::live, now);
}

void NodeRows::take(const PeerExpired& expired, Now now) {
  const RowKey key{RowKind::node, expired.id, {}};
  const Row* before = book_.find(key);
  if (before == nullptr) return;
  NodeRow row = std::get<NodeRow>(before->content);
  row.state = "OFFLINE";
  row.reason = expired.reason;
  set_live(expired.id, Live::not_heard, now);
  book_.put(key, std::move(row), Live::not_heard, now);
}

/// A node that becomes live does not make its rows live: each needs a new message.
void NodeRows::set_live(const std::string& node, Live live, Now now) {
  const auto at = nodes_.find(node);
  if (at == nodes_.end()) return;
  at->second.live = live;
  if (live == Live::live) return;
  for (const RowKey& key : book_.keys_of(node)) book_.set_live(key, live, now);
}

void NodeRows::on_silence(Now now) {
  for (const auto& [node, known] : nodes_) set_live(node, Live::not_heard, now);
}

Live NodeRows::live_of(const std::string& node) const {
  const auto at = nodes_.find(node);
  return at == nodes_.end() ? Live::not_heard : at->second.live;
}

RobotRow NodeRows::robot_of(const std::string& node) const {
  const Row* row = book_.find({RowKind::robot, node, {}});
  return row == nullptr ? RobotRow{} : std::get<RobotRow>(row->content);
}

}  // namespace trb::gateway
