#include "services/router/io/lane_server.hpp"

#include <algorithm>

#include "common/base/hex.hpp"
#include "common/config/interfaces.hpp"

namespace trb::router {
namespace {

constexpr int kSubscriptionBatch = 64;
constexpr std::size_t kBytes = 4U << 20U;  ///< that may wait for one listener
constexpr char kListen = 1;                ///< a subscription's first byte; the rest is its topic
constexpr char kListenNoMore = 0;

/// Only peers connect here, each with one connection: strangers get less room than at the inbox.
PendingConnectionLimits limits_of(const PendingConnectionLimits& inbox) {
  PendingConnectionLimits limits = inbox;
  limits.open = std::max<std::size_t>(inbox.open / 4, 32);
  limits.open_from_one = std::max<std::size_t>(inbox.open_from_one / 4, 16);
  return limits;
}

}  // namespace

LaneServer::LaneServer(Context& context, Loop& loop, LaneTable& lanes, CounterTable& counters, CurveKeys keys,
                       const PendingConnectionLimits& inbox, std::shared_ptr<ByteBudget> whole, Owner owner)
    : context_(context),
      loop_(loop),
      lanes_(lanes),
      counters_(counters),
      keys_(std::move(keys)),
      whole_(std::move(whole)),
      owner_(std::move(owner)),
      inbox_guard_(
          loop, limits_of(inbox),
          [this](const std::string& source) {
            count("refused.lane_source_blocked", "lane_source_blocked",
                  source + " has too many connections to the lane that prove nothing; dropped for 10 s");
          },
          [this](const std::string& address) {
            count("cut.no_listener", "no_listener", "the connection of " + address + " did not listen in time");
          }) {
  inbox_guard_.set_friends(owner_.friends);
  inbox_guard_.set_on_incomplete(
      [this](PendingConnectionId pending, const std::string& address) { on_incomplete(pending, address); });
}

void LaneServer::close() {
  if (socket_) loop_.remove_socket(socket_->handle());
  monitor_.reset();
  socket_.reset();
  inbox_guard_.reset();
  for (const auto& [link, listener] : listeners_) lanes_.on_listener_gone(link);
  listeners_.clear();
  also_.clear();
  port_ = 0;
  mixed_up_ = false;
}

Status LaneServer::open(const std::string& host, std::uint16_t port) {
  close();
  if (Status bound = bind("tcp://" + join_host_port(host, port)); !bound) {
    close();
    return bound;
  }
  const std::string endpoint = socket_->last_endpoint();
  port_ = static_cast<std::uint16_t>(std::stoi(endpoint.substr(endpoint.rfind(':') + 1)));
  return Done{};
}

Status LaneServer::bind(const std::string& endpoint) {
  auto made = Socket::lane_server(context_, keys_);
  if (!made) return made.error();
  socket_ = std::make_unique<Socket>(std::move(*made));
  // The monitor starts before the port opens, as at the inbox.
  auto monitor =
      SocketMonitor::watch(context_, loop_, *socket_, [this](LinkEvent event, int fd) { on_event(event, fd); });
  if (!monitor) return monitor.error();
  monitor_ = std::move(*monitor);
  loop_.add_socket(
      socket_->handle(), [this] { drain(); }, socket_->unseen());
  return socket_->bind(endpoint);
}

void LaneServer::also_at(const std::string& host) {
  const std::string endpoint = host.empty() || port_ == 0 ? "" : "tcp://" + join_host_port(host, port_);
  if (endpoint == also_) return;
  if (!also_.empty()) socket_->unbind(also_);
  also_.clear();
  if (endpoint.empty()) return;
  monitor_->catch_up();  // as at the inbox
  if (Status bound = socket_->bind(endpoint); !bound) return owner_.warn("cannot_bind", bound.error().text());
  also_ = endpoint;
}

SendResult LaneServer::publish(LinkId link, BytesView topic, Frame&& frame) {
  const auto at = listeners_.find(link);
  if (at == listeners_.end()) return SendResult::unroutable;
  return send_within(at->second.budget, frame, [&](Frame&& one) {
    // A listener with room for the first part has room for the second.
    if (const SendResult result = socket_->send(to_frame(topic), true); result != SendResult::sent) return result;
    return socket_->send(std::move(one));
  });
}

void LaneServer::link_closed(LinkId link) {
  const auto at = listeners_.find(link);
  if (at == listeners_.end()) return;
  inbox_guard_.leave(at->second.pending);
  listeners_.erase(at);
}

void LaneServer::look(const LookPart& part) {
  if (!socket_) return;
  monitor_->catch_up();
  inbox_guard_.look(0, part);
}

void LaneServer::on_incomplete(PendingConnectionId pending, const std::string& address) {
  count("cut.incomplete", "incomplete", "the connection of " + address + " to the lane sent more than a subscription");
  const auto at = std::find_if(listeners_.begin(), listeners_.end(),
                               [&](const auto& row) { return row.second.pending == pending; });
  if (at == listeners_.end()) return;
  Effects effects;
  lanes_.bar(at->first, effects);
  owner_.carry_out(effects);
}

void LaneServer::drain() {
  Frame frame;
  for (int i = 0; i < kSubscriptionBatch; ++i) {
    if (!socket_->receive(frame)) {
      mixed_up_ = false;
      return;
    }
    on_request(frame);
  }
}

/// Another connection may have had this descriptor a moment ago: first take the monitor's events, which include its
/// end.
PendingConnectionId LaneServer::pending_on(int fd) {
  monitor_->catch_up();
  return inbox_guard_.pending(fd);
}

/// libzmq 4.3.4 reports which connection a subscription came from, but subscribes the *next* one of its queue. Any
/// other message in the queue puts the two out of step, and its sender could receive what is for another. So after such
/// a message no subscription counts until the queue is empty: a subscriber in between is cut, and subscribes again.
void LaneServer::on_request(const Frame& frame) {
  const auto key = from_hex(user_id(frame));
  if (!key || key->size() != 32) return;  // libzmq's own message for an ended connection
  const int fd = subscriber_fd(frame);
  const PendingConnectionId pending = pending_on(fd);
  const BytesView request = view_of(frame);
  Effects effects;
  if (frame.more() || request.empty() || (request[0] != kListen && request[0] != kListenNoMore)) {
    mixed_up_ = true;
    lanes_.bar(*key, effects);
  } else if (mixed_up_) {
    effects.count("lane.ask_again");
  } else if (request[0] == kListen && pending != 0) {
    if (const auto link = lanes_.on_listen(*key, request.substr(1), effects)) {
      owner_.carry_out(effects);
      return listen(*link, pending, request.substr(1));
    }
  }
  owner_.carry_out(effects);
  inbox_guard_.leave(pending);
}

void LaneServer::listen(LinkId link, PendingConnectionId pending, BytesView topic) {
  socket_->let_listen(topic);
  inbox_guard_.linked(pending);
  Listener& listener = listeners_[link];
  // Who subscribes again on the same connection has used what it has used.
  if (listener.pending == pending) return;
  const PendingConnectionId old = std::exchange(listener.pending, pending);
  // A dialler makes a second connection when its first is dead; frames waiting for that one must not be in its way.
  listener.budget = std::make_shared<ByteBudget>(kBytes, whole_);
  if (old != 0) inbox_guard_.leave(old);
}

void LaneServer::count(const std::string& name, const char* event, const std::string& text) {
  counters_.count(name);
  owner_.warn(event, text);
}

void LaneServer::on_event(LinkEvent event, int fd) {
  if (event == LinkEvent::disconnected) {
    const PendingConnectionId pending = inbox_guard_.pending(fd);
    const auto at = std::find_if(listeners_.begin(), listeners_.end(),
                                 [&](const auto& row) { return row.second.pending == pending; });
    if (pending != 0 && at != listeners_.end()) {
      lanes_.on_listener_gone(at->first);
      listeners_.erase(at);
    }
  }
  inbox_guard_.on_event(event, fd);
  if (event == LinkEvent::failed && fd >= 0) return;  // the listening socket itself was closed
  switch (event) {
    case LinkEvent::accept_failed:
      return count("refused.no_descriptor", "no_descriptor", "the lane: raise the limit of open files (ulimit -n)");
    case LinkEvent::no_curve:
      return count("refused.lane_no_curve", "lane_no_curve", "a client without CURVE was refused");
    case LinkEvent::wrong_server_key:
      return count("refused.lane_wrong_server_key", "lane_wrong_server_key",
                   "a client dialled with a wrong server key");
    case LinkEvent::protocol_error:
    case LinkEvent::failed:
      return count("refused.lane_no_zmtp", "lane_no_zmtp", "a client that does not speak ZMTP, or left early");
    default:  // admit_to_lane() has reported a refused key
      return;
  }
}

}  // namespace trb::router
