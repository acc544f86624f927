#include "services/cloud-gateway/core/live/subscriptions.hpp"

#include <algorithm>

namespace trb::gateway {

/// Those that are there: whoever makes names up takes nobody's place. The same of runs.
void Subscriptions::add_sensors(const ClientFeed& client, std::set<SensorId>& out) const {
  for (const Topic& topic : client.topics()) {
    if (topic.kind == TopicKind::sensor && has_sensor(topic)) out.insert({topic.id, topic.name});
  }
}

bool Subscriptions::has_sensor(const Topic& topic) const {
  return blocks_.book().find({RowKind::sensor, topic.id, topic.name}) != nullptr;
}

Result<ClientId> Subscriptions::open() {
  if (clients_.size() == kMaxClients) {
    return fail(Errc::queue_full, "there are " + std::to_string(kMaxClients) + " clients", "close one");
  }
  clients_[++last_client_];
  return last_client_;
}

void Subscriptions::close(ClientId client) {
  if (clients_.erase(client) > 0) topics_changed_ = true;
}

std::optional<NoticeKind> Subscriptions::why_not(const Topic& topic, const Resume& resume) const {
  if (resume.instance != instance_ || resume.number > blocks_.book().head()) return NoticeKind::restarted;
  if (blocks_.is_too_old(topic, resume.number)) return NoticeKind::too_old;
  return std::nullopt;
}

Status Subscriptions::subscribe(ClientId client, const Topic& topic, std::optional<Resume> resume) {
  const auto at = clients_.find(client);
  if (at == clients_.end()) return fail(Errc::unknown_target, "client: there is none of that number");
  if (Status room = check_room(topic); !room) return room;
  topics_changed_ = true;
  if (topic.kind == TopicKind::messages) return at->second.subscribe(topic, lane_.head(), {});
  if (!resume) return at->second.subscribe(topic, 0, {});
  const auto notice = why_not(topic, *resume);
  return at->second.subscribe(topic, notice ? 0 : resume->number, notice);
}

Status Subscriptions::check_room(const Topic& topic) const {
  if (topic.kind != TopicKind::sensor || !has_sensor(topic)) return Done{};
  std::set<SensorId> sensors{{topic.id, topic.name}};
  for (const auto& [id, client] : clients_) add_sensors(client, sensors);
  if (sensors.size() <= SensorStreams::kMaxStreams) return Done{};
  return fail(Errc::queue_full, "topic: " + std::to_string(SensorStreams::kMaxStreams) + " sensors are watched",
              "close the view of one");
}

void Subscriptions::unsubscribe(ClientId client, const Topic& topic) {
  const auto at = clients_.find(client);
  if (at == clients_.end()) return;
  at->second.unsubscribe(topic);
  topics_changed_ = true;
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
      const bool is_there =
          topic.kind == TopicKind::run && blocks_.book().find({RowKind::run, {}, topic.id}) != nullptr;
      if (is_there) out.insert(topic.id);
    }
  }
  return out;
}

std::set<SensorId> Subscriptions::watched_sensors(Now now) const {
  std::set<SensorId> out;
  for (const auto& [id, client] : clients_) {
    if (!client.is_stalled(now)) add_sensors(client, out);
  }
  return out;
}

bool Subscriptions::watches_robots(Now now) const {
  return std::ranges::any_of(clients_, [&](const auto& one) {
    const ClientFeed& client = one.second;
    return !client.is_stalled(now) && (client.has(TopicKind::fleet) || client.has(TopicKind::robot));
  });
}

/// Pumps all clients together: those that keep up are at the same position and share blocks.
std::vector<ClientId> Subscriptions::pump(Now now, const RowSources& silent) {
  std::vector<ClientId> out;
  if (const auto due = next_deadline(); !due || now.mono < *due) return out;
  pumped_at_ = now.mono;
  for (auto& [id, client] : clients_) {
    if (client.pump(blocks_, lane_, silent, now)) out.push_back(id);
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

bool Subscriptions::has_changes() const {
  return pumped_head_ != blocks_.book().head() || pumped_messages_ != lane_.head() ||
         std::any_of(clients_.begin(), clients_.end(), [](const auto& one) { return one.second.is_behind(); });
}

std::optional<MonotonicTime> Subscriptions::next_deadline() const {
  if (clients_.empty()) return std::nullopt;
  if (!pumped_at_) return MonotonicTime{};
  return *pumped_at_ + (has_changes() ? kFrame : ClientFeed::kQuiet);
}

}  // namespace trb::gateway
