#include "services/ros-bridge/core/bridge_core.hpp"

#include <algorithm>

#include "common/base/number_text.hpp"
#include "services/ros-bridge/core/message_codec.hpp"

namespace trb::ros {
namespace {

using std::chrono::seconds;

/// A worker that says nothing for so long hangs, most often in a call to the ROS master.
constexpr Duration kHung = seconds(5);
constexpr Duration kStatePeriod = seconds(1);
/// A topic's type may change with the node that made it.
constexpr Duration kTypeHolds = seconds(10);
/// How long after a publication's deadline the worker may still answer.
constexpr Duration kGrace = seconds(2);
constexpr std::size_t kMaxWaiting = 256;
constexpr std::size_t kMaxTopicTypes = 256;
constexpr double kMostTimeout_s = 60;

Duration patience(double timeout_s) {
  return trb::seconds(std::clamp(timeout_s, 0.1, kMostTimeout_s));
}

/// As ROS wants it: a letter or '/' first.
bool is_topic(std::string_view name) {
  const auto first = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '/'; };
  if (name.empty() || name.size() > 255 || !first(name.front())) return false;
  return std::ranges::all_of(name, [&](char c) { return first(c) || (c >= '0' && c <= '9') || c == '_'; });
}

}  // namespace

BridgeCore::BridgeCore(BridgeSettings settings, TypeStore::Read read)
    : settings_(std::move(settings)), store_(std::move(read)), detail_("starting"), connection_(settings_.instance) {}

void BridgeCore::on_welcome(const NodeIdentity&, Now now, Outbox& out) {
  welcomed_ = true;
  send_state(now, out);
}

void BridgeCore::on(const Inbound& message, Now now, Outbox& out) {
  const auto* command = get_if<BridgeCommand>(&message.body);
  if (command != nullptr && message.source == settings_.id) return on_command(*command, now, out);
  if (holds_alternative<Nack>(message.body) || holds_alternative<Ack>(message.body)) return;
  out.count("refused.unexpected");
  out.nack(message, fail(Errc::not_permitted, "only the node's own mode-adapter may use the ROS bridge"));
}

void BridgeCore::on_command(const BridgeCommand& command, Now now, Outbox& outbox) {
  if (command.instance != adapter_) {
    adapter_ = command.instance;
    forget_adapter();
  }
  if (command.action == BridgeAction::unwatch) return forget(command.token, now);
  const BridgeOut out = out_of(outbox);
  if (!up_) return out.failed(command.token, fail(Errc::robot_offline, detail_));
  if (!is_topic(command.name)) {
    return out.failed(command.token, fail(Errc::bad_value, "'" + command.name.substr(0, 60) + "' is no topic",
                                          "begin it with a letter or '/', for example /cmd_vel"));
  }
  if (command.action == BridgeAction::publish) return begin_publish(command, now, out);
  listeners_.listen(command, now.mono + patience(command.timeout_s), now, out);
}

void BridgeCore::begin_publish(const BridgeCommand& command, Now now, const BridgeOut& out) {
  auto data = parse_json(command.data);
  if (!data) return out.failed(command.token, data.error());
  Publication publication{command.token, command.name, std::move(*data), now.mono + patience(command.timeout_s)};
  if (!command.type.empty()) return publish(std::move(publication), command.type, out);
  const auto known = topic_types_.find(command.name);
  if (known != topic_types_.end() && now.mono - known->second.heard < kTypeHolds) {
    return publish(std::move(publication), known->second.name, out);
  }
  auto& waiting = looked_up_[command.name];
  if (waiting.size() >= kMaxWaiting) {
    return out.failed(command.token, fail(Errc::queue_full, "too many messages wait for the ROS master"));
  }
  if (waiting.empty()) out.order(Word::look_up, {command.name});
  waiting.push_back(std::move(publication));
}

Result<RosTypePtr> BridgeCore::type_of(const std::string& name) {
  auto type = store_.find(name);
  if (type || type.error().code != Errc::missing) return type;
  if (const RosTypePtr heard = listeners_.heard_type(name)) return heard;
  return type;
}

void BridgeCore::publish(Publication publication, const std::string& name, const BridgeOut& out) {
  const auto type = type_of(name);
  if (!type) return out.failed(publication.token, type.error());
  auto wire = to_wire(**type, publication.data);
  if (!wire) return out.failed(publication.token, wire.error());
  if (published_.size() >= kMaxPublications) {
    return out.failed(publication.token, fail(Errc::queue_full, "too many messages wait for ROS"));
  }
  const std::uint64_t key = ++last_key_;
  out.order(Word::publish, {std::to_string(key), publication.topic, (*type)->name, (*type)->md5,
                            full_definition(**type), std::to_string(publication.deadline.ns), std::move(*wire)});
  out.outbox.count("to_ros." + publication.topic);
  published_.emplace(key, std::move(publication));
}

void BridgeCore::forget(std::uint64_t token, Now now) {
  for (auto& [topic, waiting] : looked_up_) std::erase_if(waiting, [&](const auto& one) { return one.token == token; });
  std::erase_if(published_, [&](const auto& entry) {
    if (entry.second.token != token) return false;
    drop(entry.first);
    return true;
  });
  listeners_.forget(token, now);
}

void BridgeCore::forget_adapter() {
  looked_up_.clear();
  drop_published();
  listeners_.forget_all();
}

void BridgeCore::drop_published() {
  for (const auto& [key, publication] : published_) drop(key);
  published_.clear();
}

// ---- what the worker says

void BridgeCore::on_worker_started(Now now, Outbox& out) {
  reader_ = {};
  worker_ = true;
  alive_ = now.mono;
  out.log(LogLevel::info, "worker_started", "for the ROS master at " + settings_.master);
}

void BridgeCore::on_worker_bytes(BytesView bytes, Now now, Outbox& out) {
  if (!worker_) return;
  std::vector<WorkerMessage> messages;
  const Status read = reader_.add(bytes, messages);
  for (WorkerMessage& message : messages) on_worker_message(message, now, out);
  if (read) return;
  out.log(LogLevel::error, "worker_garbled", read.error().text());
  output_.kill = true;
  on_worker_ended("the ROS worker could not be understood", now, out);
}

void BridgeCore::on_worker_message(WorkerMessage& message, Now now, Outbox& outbox) {
  alive_ = now.mono;
  const BridgeOut out = out_of(outbox);
  const auto& parts = message.parts;
  const auto token = [&parts] { return parse_number<std::uint64_t>(parts[0]).value_or(0); };
  switch (message.word) {
    case Word::alive:
      return on_alive(parts[0] == "up", parts[1], now, outbox);
    case Word::type:
      return on_type(parts[0], parts[1], now, out);
    case Word::published:
      return end_publish(token(), std::nullopt, out);
    case Word::failed:
      return end_publish(token(), error_of(message), out);
    case Word::topic_failed:
      return listeners_.on_failed(parts[0], error_of(message), now, out);
    case Word::message:
    case Word::unread:
      return listeners_.on_message(message, now, out);
    case Word::kept:
      return listeners_.on_kept(message, now, out);
    default:
      outbox.count("refused.unexpected");
  }
}

void BridgeCore::on_alive(bool up, const std::string& detail, Now now, Outbox& out) {
  if (up == up_ && (up || detail == detail_)) return;
  if (up_ && !up) {
    drop_published();  // the worker lives on, and keeps what waits for a subscriber
    forget_commands();
    listeners_.forget_all();  // it keeps its subscriptions, too
  }
  set_state(up, up ? "" : detail, now, out);
}

void BridgeCore::on_type(const std::string& topic, const std::string& type, Now now, const BridgeOut& out) {
  const auto at = looked_up_.find(topic);
  if (at == looked_up_.end()) return;
  auto waiting = std::move(at->second);
  looked_up_.erase(at);
  if (!type.empty() && (topic_types_.size() < kMaxTopicTypes || topic_types_.contains(topic))) {
    topic_types_[topic] = {type, now.mono};
  }
  for (Publication& publication : waiting) {
    if (!type.empty()) {
      publish(std::move(publication), type, out);
      continue;
    }
    out.failed(publication.token,
               fail(Errc::unknown_target, "the ROS master knows no topic " + topic,
                    "start the robot's node that listens to it, or write its type behind it in commands.json: \"" +
                        topic + " geometry_msgs/Twist\""));
  }
}

void BridgeCore::end_publish(std::uint64_t key, const std::optional<Error>& error, const BridgeOut& out) {
  const auto at = published_.find(key);
  if (at == published_.end()) return;
  const Publication publication = std::move(at->second);
  published_.erase(at);
  if (error) {
    topic_types_.erase(publication.topic);
    if (error->code == Errc::timeout) store_.forget();  // perhaps it was published by an old definition
    return out.failed(publication.token, *error);
  }
  out.done(publication.token);
}

void BridgeCore::on_worker_ended(const std::string& reason, Now now, Outbox& out) {
  worker_ = false;
  forget_commands();
  listeners_.clear();
  set_state(false, reason, now, out);
}

/// What was under way is the mode-adapter's to refuse: it sees the connection's end.
void BridgeCore::forget_commands() {
  ++connection_;
  topic_types_.clear();
  looked_up_.clear();
  published_.clear();
}

// ---- time, and what is told

void BridgeCore::tick(Now now, Outbox& out) {
  if (worker_ && now.mono - alive_ >= kHung) {
    output_.kill = true;
    on_worker_ended("the ROS master at " + settings_.master + " does not answer", now, out);
  }
  const BridgeOut parts = out_of(out);
  listeners_.tick(now, parts);
  expire(now, parts);
  if (welcomed_ && now.mono >= next_state_) send_state(now, out);
}

void BridgeCore::expire(Now now, const BridgeOut& out) {
  const auto late = [&](const Publication& publication, Duration grace) {
    if (now.mono < publication.deadline + grace) return false;
    out.failed(publication.token, fail(Errc::timeout, publication.topic + ": ROS did not take it in time"));
    return true;
  };
  for (auto& [topic, waiting] : looked_up_) {
    std::erase_if(waiting, [&](const Publication& publication) { return late(publication, Duration{}); });
  }
  std::erase_if(looked_up_, [](const auto& entry) { return entry.second.empty(); });
  std::erase_if(published_, [&](const auto& entry) {
    if (!late(entry.second, kGrace)) return false;
    drop(entry.first);  // the worker may only be blocked
    return true;
  });
}

std::optional<MonotonicTime> BridgeCore::next_deadline() const {
  std::optional<MonotonicTime> next = welcomed_ ? std::optional(next_state_) : std::nullopt;
  if (worker_) next = earlier(next, alive_ + kHung);
  for (const auto& [topic, waiting] : looked_up_) {
    for (const Publication& publication : waiting) next = earlier(next, publication.deadline);
  }
  for (const auto& [key, publication] : published_) next = earlier(next, publication.deadline + kGrace);
  return earlier(next, listeners_.next_deadline());
}

void BridgeCore::set_state(bool up, const std::string& detail, Now now, Outbox& out) {
  if (up == up_ && detail == detail_) return;
  up_ = up;
  detail_ = detail;
  out.log(up ? LogLevel::info : LogLevel::warning, "ros", up ? "the ROS master is there" : detail);
  if (welcomed_) send_state(now, out);
}

void BridgeCore::send_state(Now now, Outbox& out) {
  next_state_ = now.mono + kStatePeriod;
  out.information(settings_.id, BridgeState{connection_, up_, detail_});
}

}  // namespace trb::ros
