#include "services/router/io/lane_sockets.hpp"

#include "common/base/address.hpp"
#include "common/config/interfaces.hpp"
#include "services/router/io/event_to_end_reason.hpp"
#include "services/router/io/frame_forwarder.hpp"
#include "services/router/io/peer_sources.hpp"

namespace trb::router {
namespace {

/// Lossy frames taken in one turn, whatever the number of lanes: other messages must not wait for them.
constexpr int kLaneBatch = 8;

LaneServer::Owner owner_of(ShellContext& shell) {
  return {[&shell](Effects& effects) { shell.carry_out(effects); },
          [&shell](const char* event, const std::string& text) { shell.log(Level::warning, event, text); },
          [&shell] { return sources_of_peers(shell.core().table()); }};
}

}  // namespace

LaneSockets::LaneSockets(ShellContext& shell, FrameForwarder& forwarder, const ShellOptions& options)
    : shell_(shell),
      forwarder_(forwarder),
      keys_(options.link_keys),
      own_(shell.zmq(), shell.loop(), shell.core().lanes(), shell.core().counters(), options.link_keys,
           options.pending_connections, shell.whole(), owner_of(shell)),
      dialled_(shell) {}

void LaneSockets::publish(LinkId link, Frame&& frame) {
  const Link* to = shell_.core().table().link(link);
  if (to == nullptr) return;
  const SendResult result = own_.publish(link, topic_of(to->peer), std::move(frame));
  shell_.count(result == SendResult::sent ? "lane.sent" : "dropped.lane_full");
}

void LaneSockets::dial(const DialLane& dial, const std::string& scope) {
  if (!is_numeric_endpoint(dial.address)) return ended(dial.link, LinkEndReason::failed);
  dialled_.close(dial.link);
  if (const Status opened = open(dial, scope); !opened) {
    shell_.log(Level::warning, "no_lane", dial.address + ": " + opened.error().text());
    dialled_.close(dial.link);
    ended(dial.link, LinkEndReason::failed);
  }
}

Status LaneSockets::open(const DialLane& dial, const std::string& scope) {
  auto made = Socket::lane_client(shell_.zmq(), keys_, dial.server_key, topic_of(shell_.core().config().id));
  if (!made) return made.error();
  const LinkId link = dial.link;
  const Status added =
      dialled_.add(link, {}, std::move(*made), [this, link](LinkEvent event, int fd) { on_event(link, event, fd); });
  if (!added) return added;
  Socket& socket = *dialled_.find(link)->socket;
  shell_.loop().add_background_socket(
      socket.handle(), [this, link] { drain(link); }, socket.unseen());
  return socket.dial("tcp://" + with_scope(dial.address, scope));
}

void LaneSockets::on_event(LinkId link, LinkEvent event, int fd) {
  if (event == LinkEvent::reached) return dialled_.reached(link, fd);
  if (event == LinkEvent::connected) return shell_.core().lanes().on_connected(link, read_clocks());
  const auto end = to_end_reason(event);
  if (!end || dialled_.find(link) == nullptr) return;
  dialled_.close(link);
  ended(link, *end);
}

void LaneSockets::ended(LinkId link, LinkEndReason how) {
  Effects effects;
  shell_.core().lanes().on_ended(link, how, read_clocks(), effects);
  shell_.carry_out(effects);
}

void LaneSockets::look(const LookPart& part) {
  own_.look(part);
  for (const LinkId link : dialled_.look(part)) drain(link);
}

void LaneSockets::on_empty(LinkId link, DialledSocket& dialled) {
  if (!dialled_.ends_incomplete(dialled)) return;
  dialled_.close(link);
  Effects effects;
  shell_.core().lanes().on_incomplete(link, effects);
  shell_.core().errors().note_link(link, "incomplete", "its lane sent parts of a message without end", read_clocks());
  shell_.carry_out(effects);
}

void LaneSockets::close_link(LinkId link) {
  own_.link_closed(link);
  dialled_.close(link);
}

void LaneSockets::drain(LinkId link) {
  Frame topic;
  Frame frame;
  for (int i = 0; i < kLaneBatch; ++i) {
    DialledSocket* dialled = dialled_.find(link);
    if (dialled == nullptr) return;
    if (!dialled->socket->receive(topic)) return on_empty(link, *dialled);
    dialled->incomplete.add(topic.size());
    const bool second = topic.more() && dialled->socket->receive(frame);
    if (second) dialled->incomplete.add(frame.size());
    if (second && !frame.more()) {
      forwarder_.from_lane(link, frame);
    } else {
      if (second) dialled->incomplete.add_on_wire(dialled->socket->skip_rest(frame));
      shell_.count("refused.lane_malformed");
    }
  }
}

}  // namespace trb::router
