#include "services/cloud-gateway/core/live/subscriptions.hpp"

#include <algorithm>

namespace trb::gateway {

Result<ClientId> Subscriptions::open() {
  if (clients_.size() == kMaxClients) {
    return fail(Errc::queue_full, "there are " + std::to_string(kMaxClients) + " clients", "close one");
  }
  clients_[++last_client_];
  return last_client_;
}

void Subscriptions::close(ClientId client) {
  clients_.erase(client);
}

std::optional<NoticeKind> Subscriptions::why_not(const Topic& topic, const Resume& resume) const {
  if (resume.instance != instance_ || resume.number > blocks_.book().head()) return NoticeKind::restarted;
  if (blocks_.is_too_old(topic, resume.number)) return NoticeKind::too_old;
  return std::nullopt;
}

Status Subscriptions::subscribe(ClientId client, const Topic& topic, std::optional<Resume> resume) {
  const auto at = clients_.find(client);
  if (at == clients_.end()) return fail(Errc::unknown_target, "client: there is none of that number");
  if (topic.kind == TopicKind::messages) return at->second.subscribe(topic, lane_.head(), {});
  if (!resume) return at->second.subscribe(topic, 0, {});
  const auto notice = why_not(topic, *resume);
  return at->second.subscribe(topic, notice ? 0 : resume->number, notice);
}

void Subscriptions::unsubscribe(ClientId client, const Topic& topic) {
  if (const auto at = clients_.find(client); at != clients_.end()) at->second.unsubscribe(topic);
}

void Subscriptions::add_message(Bytes message) {
  lane_.add(std::move(message));
}

bool Subscriptions::wants_messages() const {
  return std::any_of(clients_.begin(), clients_.end(),
                     [](const auto& one) { return one.second.has(TopicKind::messages); });
}

std::set<std::string> Subscriptions::watched_runs() const {
  std::set<std::string> out;
  for (const auto& [id, client] : clients_) {
    for (const Topic& topic : client.topics()) {
      if (topic.kind == TopicKind::run) out.insert(topic.id);
    }
  }
  return out;
}

/// Pumps all clients together: those that keep up are at the same position and share blocks.
std::vector<ClientId> Subscriptions::pump(Now now) {
  std::vector<ClientId> out;
  if (const auto due = next_deadline(); !due || now.mono < *due) return out;
  pumped_at_ = now.mono;
  for (auto& [id, client] : clients_) {
    if (client.pump(blocks_, lane_, now)) out.push_back(id);
  }
  pumped_head_ = blocks_.book().head();
  pumped_messages_ = lane_.head();
  return out;
}

std::optional<Frame> Subscriptions::take(ClientId client) {
  const auto at = clients_.find(client);
  if (at == clients_.end()) return std::nullopt;
  return at->second.take();
}

bool Subscriptions::has_news() const {
  return pumped_head_ != blocks_.book().head() || pumped_messages_ != lane_.head() ||
         std::any_of(clients_.begin(), clients_.end(), [](const auto& one) { return one.second.is_behind(); });
}

std::optional<MonotonicTime> Subscriptions::next_deadline() const {
  if (clients_.empty()) return std::nullopt;
  if (!pumped_at_) return MonotonicTime{};
  return *pumped_at_ + (has_news() ? kFrame : ClientFeed::kQuiet);
}

}  // namespace trb::gateway
