// Lossy information: out by the own lane (lane_server.hpp), in by the lanes of the peers, one SUB for each.
#include "common/base/address.hpp"
#include "services/router/io/lane_server.hpp"
#include "services/router/io/router_shell.hpp"

namespace trb::router {
namespace {

/// Of what may be lost so much is taken a turn, whatever the number of lanes: what may not be lost waits no longer.
constexpr int kLaneBatch = 8;

}  // namespace

std::string RouterShell::own_lane() const {
  const bool open = !host_.address.empty() && lane_->port() != 0;
  return open ? join_host_port(without_scope(host_.address), lane_->port()) : "";
}

void RouterShell::open_lane() {
  if (host_.address.empty()) return lane_->close();
  const Status opened = lane_->open(host_.address, options_.lane_port);
  if (opened) return;
  log_limited(limit_, read_clocks().mono, Level::warning, "no_lane", opened.error().text());
  look_again_ = earlier(look_again_, read_clocks().mono + std::chrono::seconds(2));
}

void RouterShell::publish(LinkId link, Frame&& frame) {
  const Link* to = core_.table().link(link);
  if (to == nullptr) return;
  const SendResult result = lane_->publish(link, topic_of(to->peer), std::move(frame));
  core_.counters().count(result == SendResult::sent ? "lane.sent" : "dropped.lane_full");
}

void RouterShell::dial_lane(const DialLane& effect) {
  const LinkId link = effect.link;
  const auto ended = [this, link](LinkEnd how) {
    Effects effects;
    core_.lanes().on_ended(link, how, read_clocks(), effects);
    carry_out(effects);
  };
  if (!is_numeric_endpoint(effect.address)) return ended(LinkEnd::failed);
  close_heard(link);
  const auto on_event = [this, link, ended](LinkEvent event, int) {
    if (event == LinkEvent::connected) return core_.lanes().on_connected(link, read_clocks());
    const auto end = to_end(event);
    if (!end || heard_.count(link) == 0) return;
    close_heard(link);
    ended(*end);
  };
  if (const Status opened = open_lane(effect, on_event); !opened) {
    log_limited(limit_, read_clocks().mono, Level::warning, "no_lane", effect.address + ": " + opened.error().what);
    close_heard(link);
    ended(LinkEnd::failed);
  }
}

Status RouterShell::open_lane(const DialLane& effect, SocketMonitor::OnEvent on_event) {
  auto made = Socket::lane_client(context_, options_.link_keys, effect.server_key, topic_of(core_.config().id));
  if (!made) return made.error();
  Dialled dialled;
  dialled.socket = std::make_unique<Socket>(std::move(*made));
  auto monitor = SocketMonitor::watch(context_, loop_, *dialled.socket, std::move(on_event));
  if (!monitor) return monitor.error();
  dialled.monitor = std::move(*monitor);
  loop_.add_background_socket(
      dialled.socket->handle(), [this, link = effect.link] { drain_lane(link); }, dialled.socket->unseen());
  Socket* socket = dialled.socket.get();
  heard_[effect.link] = std::move(dialled);
  return socket->dial("tcp://" + to_dial(effect.address));
}

void RouterShell::close_heard(LinkId link) {
  const auto at = heard_.find(link);
  if (at == heard_.end()) return;
  loop_.remove_socket(at->second.socket->handle());
  closed_.push_back(std::move(at->second));
  heard_.erase(at);
}

void RouterShell::drain_lane(LinkId link) {
  Frame topic;
  Frame frame;
  for (int i = 0; i < kLaneBatch; ++i) {
    const auto at = heard_.find(link);
    if (at == heard_.end() || !at->second.socket->receive(topic)) return;
    const bool whole = topic.more() && at->second.socket->receive(frame) && !frame.more();
    if (whole) {
      on_lane_frame(link, frame);
    } else {
      at->second.socket->skip_rest(topic.more() ? frame : topic);
      core_.counters().count("refused.lane_malformed");
    }
  }
}

void RouterShell::on_lane_frame(LinkId link, Frame& frame) {
  const auto header = decode_frame(view_of(frame));
  if (!header) return core_.counters().count("refused.lane_malformed");
  Effects effects;
  const Routing decision = core_.forwarding().from_lane(link, *header, effects);
  if (decision.to == Routing::To::service) {
    tap('<', view_of(frame));
    const SendResult result = send_bus(decision.connection, std::move(frame));
    const Errc why = why_undelivered(result);
    core_.counters().count(result == SendResult::sent ? "lane.received" : "dropped." + std::string(errc_name(why)));
  }
  if (!effects.list.empty() || !effects.counts.empty()) carry_out(effects);
}

}  // namespace trb::router
