#include "services/router/io/inbox_guard.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <utility>

#include "common/transport/socket.hpp"

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
  const MonotonicTime now = read_clocks().mono;
  const PendingConnectionId id = pending_connections_.accepted(end ? end->source : "", now);
  by_fd_[fd] = id;
  connections_[id] = {fd, end.value_or(RemoteEnd{}), now, nullptr, false};
  if (all_carry_) (void)carries(id);
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
  suspects_.clear();
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

std::shared_ptr<IncompleteBytes> InboxGuard::carries(PendingConnectionId pending) {
  const auto at = connections_.find(pending);
  if (at == connections_.end()) return std::make_shared<IncompleteBytes>();  // it is gone already
  auto& incomplete = at->second.incomplete;
  if (incomplete == nullptr) incomplete = std::make_shared<IncompleteBytes>();
  return incomplete;
}

void InboxGuard::leave(PendingConnectionId pending) {
  // What it still sends is not read as a link's any more; its end is near.
  if (const auto at = connections_.find(pending); at != connections_.end()) at->second.leaving = true;
  pending_connections_.leave(pending, read_clocks().mono);
}

bool InboxGuard::look(std::uint64_t own_words, const LookPart& part) {
  const MonotonicTime now = read_clocks().mono;
  std::vector<PendingConnectionId> unproven;
  cursor_.visit(connections_, part, [&](PendingConnectionId id, const Connection& connection) {
    const auto& incomplete = connection.incomplete;
    if (connection.leaving || (incomplete != nullptr && incomplete->is_suspected())) return;
    const auto read = bytes_read(connection.fd);
    if (!read) return;
    const double words_in_all = static_cast<double>(own_words) * to_seconds(now - connection.accepted);
    const std::uint64_t words = std::min(*read, static_cast<std::uint64_t>(words_in_all));
    if (incomplete == nullptr) {
      if (*read - words > kMostUnproven) unproven.push_back(id);
    } else if (incomplete->look(*read - words)) {
      suspect(id);
    }
  });
  cut_incomplete(unproven);
  return !suspects_.empty();
}

/// libzmq takes a message of each connection in turn, and each has so many complete ones at most. Twice that, as
/// connections may come meanwhile.
void InboxGuard::suspect(PendingConnectionId id) {
  suspects_.push_back({id, received_ + 2 * (connections_.size() + 1) * kLinkReceiveHighWaterMark});
}

void InboxGuard::on_empty() {
  if (!suspects_.empty()) conclude(suspects_.size());
}

void InboxGuard::on_turn(std::size_t messages) {
  received_ += messages;
  const auto waits = std::ranges::find_if(suspects_, [&](const Suspect& one) { return one.enough > received_; });
  conclude(static_cast<std::size_t>(waits - suspects_.begin()));
}

/// What was complete at the looks at the first of the suspects has been received.
void InboxGuard::conclude(std::size_t first) {
  std::vector<PendingConnectionId> over;
  for (; first > 0; --first) {
    const PendingConnectionId id = suspects_.front().id;
    suspects_.pop_front();
    const auto at = connections_.find(id);
    if (at == connections_.end() || !at->second.incomplete->on_empty() || at->second.leaving) continue;
    over.push_back(id);
  }
  cut_incomplete(over);
}

void InboxGuard::cut_incomplete(const std::vector<PendingConnectionId>& all) {
  for (const PendingConnectionId id : all) {
    const auto at = connections_.find(id);
    // The descriptor may be another connection's by now, and the end of this one not yet reported.
    if (at == connections_.end() || !is_connection(at->second.fd, at->second.end)) continue;
    const std::string address = at->second.end.address;
    cut_connection(at->second.fd, at->second.end);
    leave(id);
    if (on_incomplete_) on_incomplete_(id, address);
  }
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
