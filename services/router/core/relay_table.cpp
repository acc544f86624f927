#include "services/router/core/relay_table.hpp"

#include <utility>

namespace trb::router {

RelayRoute& RelayTable::row(const Peer& peer) {
  RelayRoute& route = rows_[peer.id];
  if (touched_.empty() || touched_.back() != peer.id) touched_.push_back(peer.id);
  if (route.number == peer.number) return route;
  // Another computer under the same name counts its own boots and messages.
  const RouterConfig& own = node_.config();
  route.number = peer.number;
  route.open = false;
  route.key.clear();
  route.connection = RelayConnection(own.boot, {.lease = own.timing.lease, .alive = own.timing.keep_alive});
  return route;
}

const RelayRoute& RelayTable::find(const Peer& peer) const {
  static const RelayRoute kNone;
  const auto at = rows_.find(peer.id);
  return at == rows_.end() || at->second.number != peer.number ? kNone : at->second;
}

const std::set<std::string, std::less<>>& RelayTable::open() const {
  refresh();
  return open_;
}

const std::set<std::string, std::less<>>& RelayTable::untold() const {
  refresh();
  return untold_;
}

std::vector<std::string> RelayTable::due(MonotonicTime now) const {
  refresh();
  return due_.due(now);
}

std::optional<MonotonicTime> RelayTable::earliest() const {
  refresh();
  return due_.earliest();
}

void RelayTable::drop_without_peer() {
  if (std::exchange(forgotten_, peers_.forgotten()) == peers_.forgotten()) return;
  const auto is_gone = [&](const std::string& id) { return peers_.find(id) == nullptr; };
  for (auto& [id, route] : rows_) {
    if (!is_gone(id)) continue;
    due_.set(id, route.due, std::nullopt);
    open_.erase(id);
    untold_.erase(id);
  }
  std::erase_if(rows_, [&](const auto& row) { return is_gone(row.first); });
}

void RelayTable::refresh() const {
  if (std::exchange(newest_profile_, profile_.number()) != profile_.number()) {
    touched_.insert(touched_.end(), open_.begin(), open_.end());
  }
  for (const std::string& id : touched_) {
    if (const auto at = rows_.find(id); at != rows_.end()) refresh(at->second, id);
  }
  touched_.clear();
}

void RelayTable::refresh(RelayRoute& route, const std::string& id) const {
  const Peer* peer = peers_.find(id);
  const bool known = peer != nullptr && peer->number == route.number;
  const bool untold = known && route.open && peer->link == 0 && route.told_profile != newest_profile_;
  const auto keep = [&](auto& ids, bool in) { in ? void(ids.insert(id)) : void(ids.erase(id)); };
  keep(open_, route.open);
  keep(untold_, untold);
  due_.set(id, route.due, known ? route.connection.next_deadline() : std::nullopt);
}

}  // namespace trb::router
