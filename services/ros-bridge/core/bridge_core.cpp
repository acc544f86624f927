#include "services/ros-bridge/core/bridge_core.hpp"

#include <algorithm>

#include "common/base/number_text.hpp"
#include "services/ros-bridge/core/message_codec.hpp"
#include "services/ros-bridge/core/select.hpp"

namespace trb::ros {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// A worker that says nothing for so long hangs, most often in a call to the ROS master.
constexpr Duration kHung = seconds(5);
constexpr Duration kStatePeriod = seconds(1);
constexpr Duration kWatchPeriod = milliseconds(100);
/// A topic's type may change with the node that made it.
constexpr Duration kTypeHolds = seconds(10);
constexpr Duration kIdle = seconds(30);
/// How long after its own patience the worker may still answer.
constexpr Duration kGrace = seconds(2);
constexpr std::size_t kMaxWaiting = 256;
constexpr std::size_t kMaxTopics = 256;
constexpr std::size_t kMaxHeardTypes = 500;
constexpr std::size_t kMaxData = 65536;
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

/// What a listener wants of a topic's message, as JSON.
Result<std::string> selected_json(const Result<Value>& message, const std::vector<std::string>& paths,
                                  const std::string& topic) {
  const auto selected = message ? select(*message, paths) : message;
  if (!selected) return selected.error();
  std::string data = dump_json(*selected);
  if (data.size() <= kMaxData) return data;
  return fail(Errc::too_large, topic + ": over 64 kB of JSON",
              "name the fields that are needed in commands.json: \"TOPIC field.path\"");
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

void BridgeCore::on_command(const BridgeCommand& command, Now now, Outbox& out) {
  if (command.instance != adapter_) {
    adapter_ = command.instance;
    forget_adapter();
  }
  if (command.action == BridgeAction::unwatch) return forget(command.token, now);
  if (!up_) return fail_event(command.token, fail(Errc::robot_offline, detail_), out);
  if (!is_topic(command.name)) {
    return fail_event(command.token,
                      fail(Errc::bad_value, "'" + command.name.substr(0, 60) + "' is no topic",
                           "begin it with a letter or '/', for example /cmd_vel"),
                      out);
  }
  if (command.action == BridgeAction::publish) return begin_publish(command, now, out);
  listen(command, now, out);
}

void BridgeCore::begin_publish(const BridgeCommand& command, Now now, Outbox& out) {
  auto data = parse_json(command.data);
  if (!data) return fail_event(command.token, data.error(), out);
  Publication publication{command.token, command.name, std::move(*data), now.mono + patience(command.timeout_s)};
  if (!command.type.empty()) return publish(std::move(publication), command.type, now, out);
  const auto known = topic_types_.find(command.name);
  if (known != topic_types_.end() && now.mono - known->second.heard < kTypeHolds) {
    return publish(std::move(publication), known->second.name, now, out);
  }
  auto& waiting = looked_up_[command.name];
  if (waiting.size() >= kMaxWaiting) {
    return fail_event(command.token, fail(Errc::queue_full, "too many messages wait for the ROS master"), out);
  }
  if (waiting.empty()) send_to_worker(Word::look_up, {command.name});
  waiting.push_back(std::move(publication));
}

Result<RosTypePtr> BridgeCore::type_of(const std::string& name) {
  auto type = store_.find(name);
  if (type || type.error().code != Errc::missing) return type;
  for (const auto& [sum, heard] : heard_types_) {
    if (heard->name == name) return heard;
  }
  return type;
}

void BridgeCore::publish(Publication publication, const std::string& name, Now now, Outbox& out) {
  const auto type = type_of(name);
  if (!type) return fail_event(publication.token, type.error(), out);
  auto wire = to_wire(**type, publication.data);
  if (!wire) return fail_event(publication.token, wire.error(), out);
  if (published_.size() >= kMaxPublications) {
    return fail_event(publication.token, fail(Errc::queue_full, "too many messages wait for ROS"), out);
  }
  const auto left = std::chrono::duration_cast<milliseconds>(publication.deadline - now.mono).count();
  const std::uint64_t key = ++last_key_;
  send_to_worker(Word::publish,
                 {std::to_string(key), publication.topic, (*type)->name, (*type)->md5, full_definition(**type),
                  std::to_string(std::max<std::int64_t>(left, 0)), std::move(*wire)});
  out.count("to_ros." + publication.topic);
  published_.emplace(key, std::move(publication));
}

void BridgeCore::listen(const BridgeCommand& command, Now now, Outbox& out) {
  const auto known = topics_.find(command.name);
  if (known == topics_.end() && topics_.size() >= kMaxTopics) {
    return fail_event(command.token, fail(Errc::queue_full, "too many topics are listened to"), out);
  }
  Topic& topic = topics_[command.name];
  if (topic.listeners.size() >= kMaxWaiting) {
    return fail_event(command.token, fail(Errc::queue_full, "too many wait for " + command.name), out);
  }
  // Also for a known one: a latched topic says nothing more for whoever comes later.
  send_to_worker(Word::subscribe, {command.name});
  topic.idle_since.reset();
  topic.listeners.push_back({command.token, command.paths, command.action == BridgeAction::watch,
                             now.mono + patience(command.timeout_s), now.mono});
}

void BridgeCore::forget(std::uint64_t token, Now now) {
  for (auto& [topic, waiting] : looked_up_) std::erase_if(waiting, [&](const auto& one) { return one.token == token; });
  std::erase_if(published_, [&](const auto& entry) {
    if (entry.second.token != token) return false;
    send_to_worker(Word::drop, {std::to_string(entry.first)});
    return true;
  });
  for (auto& [name, topic] : topics_) {
    const auto ended = std::erase_if(topic.listeners, [&](const auto& one) { return one.token == token; });
    if (ended > 0 && topic.listeners.empty()) topic.idle_since = now.mono;
  }
}

void BridgeCore::forget_adapter() {
  looked_up_.clear();
  drop_published();
  for (auto& [name, topic] : topics_) topic.listeners.clear();
}

void BridgeCore::drop_published() {
  for (const auto& [key, publication] : published_) send_to_worker(Word::drop, {std::to_string(key)});
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

void BridgeCore::on_worker_message(WorkerMessage& message, Now now, Outbox& out) {
  alive_ = now.mono;
  const auto& parts = message.parts;
  const auto token = [&parts] { return parse_number<std::uint64_t>(parts[0]).value_or(0); };
  const auto error = [&parts] { return Error{errc_of(parts[1]).value_or(Errc::robot_error), parts[2], parts[3]}; };
  switch (message.word) {
    case Word::alive:
      return on_alive(parts[0] == "up", parts[1], now, out);
    case Word::type:
      return on_type(parts[0], parts[1], now, out);
    case Word::published:
      return end_publish(token(), std::nullopt, out);
    case Word::failed:
      return end_publish(token(), error(), out);
    case Word::topic_failed:
      return on_topic_failed(parts[0], error(), now, out);
    case Word::message:
      return on_message(message, now, out);
    case Word::kept:
      return on_kept(message, now, out);
    default:
      out.count("refused.unexpected");
  }
}

void BridgeCore::on_alive(bool up, const std::string& detail, Now now, Outbox& out) {
  if (up == up_ && (up || detail == detail_)) return;
  if (up_ && !up) {
    drop_published();  // the worker lives on, and keeps what waits for a subscriber
    forget_all();
  }
  set_state(up, up ? "" : detail, now, out);
}

void BridgeCore::on_type(const std::string& topic, const std::string& type, Now now, Outbox& out) {
  const auto at = looked_up_.find(topic);
  if (at == looked_up_.end()) return;
  auto waiting = std::move(at->second);
  looked_up_.erase(at);
  if (!type.empty() && (topic_types_.size() < kMaxTopics || topic_types_.contains(topic))) {
    topic_types_[topic] = {type, now.mono};
  }
  for (Publication& publication : waiting) {
    if (!type.empty()) {
      publish(std::move(publication), type, now, out);
      continue;
    }
    fail_event(publication.token,
               fail(Errc::unknown_target, "the ROS master knows no topic " + topic,
                    "start the robot's node that listens to it, or write its type behind it in commands.json: \"" +
                        topic + " geometry_msgs/Twist\""),
               out);
  }
}

void BridgeCore::end_publish(std::uint64_t key, const std::optional<Error>& error, Outbox& out) {
  const auto at = published_.find(key);
  if (at == published_.end()) return;
  const Publication publication = std::move(at->second);
  published_.erase(at);
  if (error) {
    topic_types_.erase(publication.topic);
    return fail_event(publication.token, *error, out);
  }
  event(publication.token, BridgeResult::done, {}, std::nullopt, out);
}

Result<Value> BridgeCore::read_message(const WorkerMessage& message) {
  const std::string& name = message.parts[1];
  const std::string& sum = message.parts[2];
  auto known = heard_types_.find(sum);
  if (known == heard_types_.end()) {
    auto type = type_from_full_definition(name, message.parts[3]);
    if (!type) return type.error();
    if ((*type)->md5 != sum) {
      return fail(Errc::version_mismatch, name + ": its sender's definition and sum " + sum + " do not belong together",
                  "look at the node that publishes it");
    }
    if (heard_types_.size() >= kMaxHeardTypes) heard_types_.clear();
    known = heard_types_.emplace(sum, *type).first;
  }
  return to_json(*known->second, message.parts[4]);
}

void BridgeCore::on_message(WorkerMessage& message, Now now, Outbox& out) {
  const auto at = topics_.find(message.parts[0]);
  if (at == topics_.end()) return;
  Topic& topic = at->second;
  for (Listener& listener : topic.listeners) listener.owed = true;
  topic.newest.reset();
  if (send_message(topic, message, now, out)) topic.newest = std::move(message);
}

void BridgeCore::on_kept(const WorkerMessage& message, Now now, Outbox& out) {
  const auto at = topics_.find(message.parts[0]);
  if (at == topics_.end()) return;
  Topic& topic = at->second;
  for (Listener& listener : topic.listeners) listener.owed = listener.owed || !listener.told;
  // What others are still owed is newer.
  if (!send_message(topic, topic.newest ? *topic.newest : message, now, out)) topic.newest.reset();
}

void BridgeCore::on_topic_failed(const std::string& topic, const Error& error, Now now, Outbox& out) {
  const auto at = topics_.find(topic);
  if (at == topics_.end()) return;
  for (const Listener& listener : std::exchange(at->second.listeners, {})) fail_event(listener.token, error, out);
  at->second.newest.reset();
  if (!at->second.idle_since) at->second.idle_since = now.mono;
}

bool BridgeCore::send_message(Topic& topic, const WorkerMessage& message, Now now, Outbox& out) {
  auto& listeners = topic.listeners;
  const auto is_due = [&](const Listener& one) { return one.owed && (!one.watch || now.mono >= one.next); };
  if (!std::ranges::any_of(listeners, is_due)) return std::ranges::any_of(listeners, &Listener::owed);
  out.count("from_ros." + message.parts[0]);
  const auto value = read_message(message);
  std::erase_if(listeners, [&](Listener& listener) {
    if (!is_due(listener)) return false;
    listener.owed = false;
    listener.told = true;
    listener.next = now.mono + kWatchPeriod;
    auto data = selected_json(value, listener.paths, message.parts[0]);
    if (!data) {
      fail_event(listener.token, data.error(), out);
      return true;
    }
    event(listener.token, BridgeResult::value, std::move(*data), std::nullopt, out);
    return !listener.watch;
  });
  if (listeners.empty()) topic.idle_since = now.mono;
  return std::ranges::any_of(listeners, &Listener::owed);
}

/// A topic that tells only changes may say nothing more for hours: its last message must not be lost.
void BridgeCore::send_owed(Now now, Outbox& out) {
  for (auto& [name, topic] : topics_) {
    if (topic.newest && !send_message(topic, *topic.newest, now, out)) topic.newest.reset();
  }
}

void BridgeCore::on_worker_ended(const std::string& reason, Now now, Outbox& out) {
  worker_ = false;
  forget_all();
  set_state(false, reason, now, out);
}

/// What was under way is the mode-adapter's to refuse: it sees the connection's end.
void BridgeCore::forget_all() {
  ++connection_;
  topic_types_.clear();
  looked_up_.clear();
  published_.clear();
  topics_.clear();
}

// ---- time, and what is told

void BridgeCore::tick(Now now, Outbox& out) {
  if (worker_ && now.mono - alive_ >= kHung) {
    output_.kill = true;
    on_worker_ended("the ROS master at " + settings_.master + " does not answer", now, out);
  }
  send_owed(now, out);
  expire(now, out);
  if (welcomed_ && now.mono >= next_state_) send_state(now, out);
}

void BridgeCore::expire(Now now, Outbox& out) {
  const auto late = [&](const Publication& publication, Duration grace) {
    if (now.mono < publication.deadline + grace) return false;
    fail_event(publication.token, fail(Errc::timeout, publication.topic + ": ROS did not take it in time"), out);
    return true;
  };
  for (auto& [topic, waiting] : looked_up_) {
    std::erase_if(waiting, [&](const Publication& publication) { return late(publication, Duration{}); });
  }
  std::erase_if(looked_up_, [](const auto& entry) { return entry.second.empty(); });
  std::erase_if(published_, [&](const auto& entry) { return late(entry.second, kGrace); });
  expire_listeners(now, out);
}

void BridgeCore::expire_listeners(Now now, Outbox& out) {
  for (auto& [name, topic] : topics_) {
    std::erase_if(topic.listeners, [&, &topic_name = name](const Listener& listener) {
      if (listener.watch || now.mono < listener.deadline) return false;
      fail_event(listener.token,
                 fail(Errc::timeout, "nobody has said anything on " + topic_name,
                      "look whether the robot's node publishes it: rostopic hz " + topic_name),
                 out);
      return true;
    });
    if (topic.listeners.empty() && !topic.idle_since) topic.idle_since = now.mono;
  }
  std::erase_if(topics_, [&](const auto& entry) {
    if (!entry.second.idle_since || now.mono - *entry.second.idle_since < kIdle) return false;
    send_to_worker(Word::unsubscribe, {entry.first});
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
  for (const auto& [name, topic] : topics_) {
    for (const Listener& listener : topic.listeners) {
      if (!listener.watch) next = earlier(next, listener.deadline);
      if (listener.owed) next = earlier(next, listener.next);
    }
  }
  return next;
}

void BridgeCore::event(std::uint64_t token, BridgeResult result, std::string data, const std::optional<Error>& error,
                       Outbox& out) const {
  BridgeEvent event{adapter_, token, result, std::move(data), {}, {}, {}};
  if (error) {
    event.code = std::string(errc_name(error->code));
    event.what = error->what;
    event.hint = error->hint;
    out.count("refused." + event.code);
  }
  out.information(settings_.id, std::move(event));
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
