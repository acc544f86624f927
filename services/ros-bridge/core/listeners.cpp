#include "services/ros-bridge/core/listeners.hpp"

#include <algorithm>
#include <utility>

#include "services/ros-bridge/core/message_codec.hpp"
#include "services/ros-bridge/core/select.hpp"

namespace trb::ros {
namespace {

constexpr Duration kWatchPeriod = std::chrono::milliseconds(100);
constexpr std::size_t kMaxHeardTypes = 500;
constexpr std::size_t kMaxData = 65536;

}  // namespace

void Listeners::listen(const BridgeCommand& command, MonotonicTime deadline, Now now, const BridgeOut& out) {
  const auto known = topics_.find(command.name);
  if (known == topics_.end() && topics_.size() >= kMaxTopics) {
    return out.failed(command.token, fail(Errc::queue_full, "too many topics are listened to"));
  }
  Topic& topic = topics_[command.name];
  if (topic.listeners.size() >= kMaxOfTopic) {
    return out.failed(command.token, fail(Errc::queue_full, "too many wait for " + command.name));
  }
  // Also for a known one: a latched topic says nothing more for whoever comes later.
  out.order(Word::subscribe, {command.name});
  topic.idle_since.reset();
  topic.listeners.push_back({command.token, command.paths, command.action == BridgeAction::watch, deadline, now.mono});
}

void Listeners::forget(std::uint64_t token, Now now) {
  for (auto& [name, topic] : topics_) {
    const auto ended = std::erase_if(topic.listeners, [&](const auto& one) { return one.token == token; });
    if (ended > 0 && topic.listeners.empty()) topic.idle_since = now.mono;
  }
}

void Listeners::forget_all() {
  for (auto& [name, topic] : topics_) topic.listeners.clear();
}

Result<RosTypePtr> Listeners::type_of(const WorkerMessage& message) {
  if (message.word == Word::unread) return error_of(message);
  const std::string& name = message.parts[1];
  const std::string& sum = message.parts[2];
  auto known = heard_types_.find(name);
  if (known == heard_types_.end() || known->second->md5 != sum) {
    auto type = type_from_full_definition(name, message.parts[3]);
    if (!type) return type.error();
    if ((*type)->md5 != sum) {
      return fail(Errc::version_mismatch, name + ": its sender's definition and sum " + sum + " do not belong together",
                  "look at the node that publishes it");
    }
    if (known == heard_types_.end() && heard_types_.size() >= kMaxHeardTypes) heard_types_.clear();
    known = heard_types_.insert_or_assign(name, *type).first;
  }
  return known->second;
}

Result<std::string> Listeners::json_of(const WorkerMessage& message, const std::vector<std::string>& paths) {
  const auto type = type_of(message);
  if (!type) return type.error();
  const auto value = to_json(**type, message.parts[4], paths);
  const auto selected = value ? select(*value, paths) : value;
  if (!selected) return selected.error();
  std::string data = dump_json(*selected);
  if (data.size() <= kMaxData) return data;
  return fail(Errc::too_large, message.parts[0] + ": over 64 kB of JSON",
              "name the fields that are needed in commands.json: \"TOPIC field.path\"");
}

RosTypePtr Listeners::heard_type(const std::string& name) const {
  const auto heard = heard_types_.find(name);
  return heard == heard_types_.end() ? nullptr : heard->second;
}

void Listeners::on_message(WorkerMessage& message, Now now, const BridgeOut& out) {
  const auto at = topics_.find(message.parts[0]);
  if (at == topics_.end()) return;
  Topic& topic = at->second;
  for (Listener& listener : topic.listeners) listener.owed = true;
  topic.newest.reset();
  if (send_message(topic, message, now, out)) topic.newest = std::move(message);
}

void Listeners::on_kept(const WorkerMessage& message, Now now, const BridgeOut& out) {
  const auto at = topics_.find(message.parts[0]);
  if (at == topics_.end()) return;
  Topic& topic = at->second;
  for (Listener& listener : topic.listeners) listener.owed = listener.owed || !listener.told;
  // What others are still owed is newer.
  if (!send_message(topic, topic.newest ? *topic.newest : message, now, out)) topic.newest.reset();
}

void Listeners::on_failed(const std::string& topic, const Error& error, Now now, const BridgeOut& out) {
  const auto at = topics_.find(topic);
  if (at == topics_.end()) return;
  for (const Listener& listener : std::exchange(at->second.listeners, {})) out.failed(listener.token, error);
  at->second.newest.reset();
  if (!at->second.idle_since) at->second.idle_since = now.mono;
}

bool Listeners::send_message(Topic& topic, const WorkerMessage& message, Now now, const BridgeOut& out) {
  auto& listeners = topic.listeners;
  const auto is_due = [&](const Listener& one) { return one.owed && (!one.watch || now.mono >= one.next); };
  if (!std::ranges::any_of(listeners, is_due)) return std::ranges::any_of(listeners, &Listener::owed);
  out.outbox.count("from_ros." + message.parts[0]);
  std::map<std::vector<std::string>, Result<std::string>> read;  // many may ask for the same
  std::erase_if(listeners, [&](Listener& listener) {
    if (!is_due(listener)) return false;
    listener.owed = false;
    listener.told = true;
    listener.next = now.mono + kWatchPeriod;
    auto known = read.find(listener.paths);
    if (known == read.end()) known = read.emplace(listener.paths, json_of(message, listener.paths)).first;
    const auto& data = known->second;
    if (data) {
      out.value(listener.token, *data);
    } else {
      // The next message may be good: fault rules that watch it must not be blind for ever.
      listener.watch ? out.unknown(listener.token, data.error()) : out.failed(listener.token, data.error());
    }
    return !listener.watch;
  });
  if (listeners.empty()) topic.idle_since = now.mono;
  return std::ranges::any_of(listeners, &Listener::owed);
}

void Listeners::tick(Now now, const BridgeOut& out) {
  send_owed(now, out);
  expire(now, out);
}

/// A topic that tells only changes may say nothing more for hours: its last message must not be lost.
void Listeners::send_owed(Now now, const BridgeOut& out) {
  for (auto& [name, topic] : topics_) {
    if (topic.newest && !send_message(topic, *topic.newest, now, out)) topic.newest.reset();
  }
}

void Listeners::expire(Now now, const BridgeOut& out) {
  for (auto& [name, topic] : topics_) {
    std::erase_if(topic.listeners, [&, &topic_name = name](const Listener& listener) {
      if (listener.watch || now.mono < listener.deadline) return false;
      out.failed(listener.token, fail(Errc::timeout, "nobody has said anything on " + topic_name,
                                      "look whether the robot's node publishes it: rostopic hz " + topic_name));
      return true;
    });
    if (topic.listeners.empty() && !topic.idle_since) topic.idle_since = now.mono;
  }
  std::erase_if(topics_, [&](const auto& entry) {
    if (!entry.second.idle_since || now.mono - *entry.second.idle_since < kIdle) return false;
    out.order(Word::unsubscribe, {entry.first});
    return true;
  });
}

std::optional<MonotonicTime> Listeners::next_deadline() const {
  std::optional<MonotonicTime> next;
  for (const auto& [name, topic] : topics_) {
    for (const Listener& listener : topic.listeners) {
      if (!listener.watch) next = earlier(next, listener.deadline);
      if (listener.owed) next = earlier(next, listener.next);
    }
  }
  return next;
}

}  // namespace trb::ros
