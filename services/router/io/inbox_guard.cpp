#include "services/router/io/inbox_guard.hpp"

#include <sys/resource.h>

namespace trb::router {

InboxGuard::InboxGuard(Loop& loop, PendingConnectionLimits limits, std::function<void(const std::string&)> on_blocked,
                       std::function<void(const std::string&)> on_cut)
    : on_blocked_(std::move(on_blocked)), on_cut_(std::move(on_cut)), pending_connections_(limits) {
  loop.add_timer([this] { return pending_connections_.next_deadline(); },
                 [this](Now now) {
                   pending_connections_.tick(now.mono);
                   carry_out();
                 });
}

void InboxGuard::on_event(LinkEvent event, int fd) {
  if (event == LinkEvent::listening) return filter_.add_listener(fd);
  if (event == LinkEvent::accepted) return on_accepted(fd);
  if (fd < 0 || event == LinkEvent::connected) return;
  filter_.remove_listener(fd);
  const auto at = by_fd_.find(fd);
  if (at == by_fd_.end()) return;
  pending_connections_.gone(at->second, read_clocks().mono);
  connections_.erase(at->second);
  by_fd_.erase(at);
  carry_out();
}

void InboxGuard::on_accepted(int fd) {
  // The connection may be gone already: then the next event of this descriptor is its end.
  const auto end = remote_end(fd);
  const PendingConnectionId id = pending_connections_.accepted(end ? end->source : "", read_clocks().mono);
  by_fd_[fd] = id;
  connections_[id] = {fd, end.value_or(RemoteEnd{})};
  carry_out();
}

void InboxGuard::reset() {
  const MonotonicTime now = read_clocks().mono;
  for (const auto& [fd, id] : by_fd_) {
    pending_connections_.linked(id);  // that is not the connection's fault
    pending_connections_.gone(id, now);
  }
  by_fd_.clear();
  connections_.clear();
  filter_ = SourceFilter();
  set_filter();
}

bool InboxGuard::is_undecided(int fd) const {
  return pending_connections_.undecided(pending(fd));
}

PendingConnectionId InboxGuard::pending(int fd) const {
  const auto at = by_fd_.find(fd);
  return at == by_fd_.end() ? 0 : at->second;
}

void InboxGuard::linked(PendingConnectionId pending) {
  pending_connections_.linked(pending);
  carry_out();
}

void InboxGuard::leave(PendingConnectionId pending) {
  pending_connections_.leave(pending, read_clocks().mono);
}

void InboxGuard::set_filter() {
  std::vector<std::string> sources;
  for (const auto& [source, until] : pending_connections_.blocked()) sources.push_back(source);
  const bool closed = pending_connections_.closed();
  (void)filter_.set(sources, closed, closed && friends_ ? friends_() : std::vector<std::string>{});
}

void InboxGuard::carry_out() {
  const PendingConnections::Orders orders = pending_connections_.take_orders();
  for (const PendingConnectionId id : orders.cut) {
    if (const auto at = connections_.find(id); at != connections_.end()) {
      cut_connection(at->second.fd, at->second.end);
    }
  }
  for (const PendingConnectionId id : orders.expired) {
    if (const auto at = connections_.find(id); at != connections_.end()) on_cut_(at->second.end.address);
  }
  for (const std::string& source : orders.newly_blocked) on_blocked_(source);
  if (orders.filter_changed) set_filter();
}

std::size_t raise_descriptor_limit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return kLeastDescriptors;
  const rlimit most{limit.rlim_max, limit.rlim_max};
  return ::setrlimit(RLIMIT_NOFILE, &most) == 0 ? most.rlim_cur : limit.rlim_cur;
}

}  // namespace trb::router
