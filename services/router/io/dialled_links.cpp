#include "services/router/io/dialled_links.hpp"

#include "common/base/address.hpp"
#include "common/config/interfaces.hpp"
#include "common/transport/socket.hpp"
#include "services/router/io/event_to_end_reason.hpp"
#include "services/router/io/frame_forwarder.hpp"
#include "services/router/io/turn_budget.hpp"

namespace trb::router {
DialledLinks::DialledLinks(ShellContext& shell, FrameForwarder& forwarder, CurveKeys keys)
    : shell_(shell), forwarder_(forwarder), keys_(std::move(keys)), dialled_(shell) {}

bool DialledLinks::dial(const Dial& dial, const std::string& scope) {
  if (is_numeric_endpoint(dial.address)) return dial_numbers(dial, scope, "");
  const Now now = read_clocks();
  const Resolver::Found found = resolver_.find(dial.address, now.mono);
  if (!found.address.empty()) {
    shell_.core().links().on_name_found(dial.link, found.address);
    return dial_numbers({dial.link, found.address, dial.server_key}, scope, dial.address);
  }
  Effects effects;
  shell_.core().links().on_name_unknown(dial.link, found.row, now, effects);
  shell_.carry_out(effects);
  return true;
}

/// libzmq would ask the name server on the one thread that carries everything: it gets only numeric addresses.
bool DialledLinks::dial_numbers(const Dial& dial, const std::string& scope, const std::string& name) {
  const Status opened = open(dial, scope, name);
  if (opened) return true;
  shell_.count("dial.no_descriptor");
  shell_.log(Level::error, "no_descriptor",
             dial.address + " cannot be dialled: " + opened.error().what + "; raise the limit of open files");
  return false;
}

Status DialledLinks::open(const Dial& dial, const std::string& scope, const std::string& name) {
  auto made = Socket::dialler(shell_.zmq(), keys_, dial.server_key);
  if (!made) return made.error();
  const LinkId link = dial.link;
  Dialled dialled;
  dialled.queue = new_link_queue(shell_);
  dialled.name = name;
  const Status added = dialled_.add(link, std::move(dialled), std::move(*made),
                                    [this, link](LinkEvent event, int fd) { on_event(link, event, fd); });
  if (!added) return added;
  Socket& socket = *dialled_.find(link)->socket;
  shell_.loop().add_socket(
      socket.handle(), [this, link] { drain(link); }, socket.unseen());
  if (const Status sent = socket.dial("tcp://" + with_scope(dial.address, scope)); !sent) {
    shell_.log(Level::warning, "dial_failed", sent.error().what);
  }
  return Done{};
}

void DialledLinks::on_event(LinkId link, LinkEvent event, int fd) {
  if (event == LinkEvent::reached) return dialled_.reached(link, fd);
  Effects effects;
  if (const auto end = to_end_reason(event)) {
    shell_.core().links().on_ended(link, *end, read_clocks(), effects);
  } else {
    shell_.core().handshake().on_dial_connected(link, read_clocks(), effects);
  }
  shell_.carry_out(effects);
}

void DialledLinks::close(LinkId link) {
  const Dialled* dialled = dialled_.find(link);
  if (dialled == nullptr) return;
  if (!dialled->name.empty()) resolver_.ended(dialled->name, read_clocks().mono);
  dialled_.close(link);
}

std::optional<bool> DialledLinks::has_room(LinkId link, std::size_t bytes) const {
  const Dialled* dialled = dialled_.find(link);
  if (dialled == nullptr) return std::nullopt;
  return dialled->queue->has_room(bytes);
}

std::optional<bool> DialledLinks::has_share(LinkId link, std::string_view peer, std::size_t bytes) {
  const Dialled* dialled = dialled_.find(link);
  if (dialled == nullptr) return std::nullopt;
  return dialled->queue->has_share(peer, bytes);
}

std::optional<SendResult> DialledLinks::send(LinkId link, Frame&& frame, std::string_view peer) {
  const Dialled* dialled = dialled_.find(link);
  if (dialled == nullptr) return std::nullopt;
  Socket& socket = *dialled->socket;
  return dialled->queue->send(peer, frame, [&](Frame&& one) { return socket.send(std::move(one)); });
}

void DialledLinks::drain(LinkId link) {
  Frame frame;
  TurnBudget turn(shell_);
  while (turn.has_left()) {
    Dialled* dialled = dialled_.find(link);
    if (dialled == nullptr) return;
    if (!dialled->socket->receive(frame)) return on_empty(link, *dialled);
    turn.take_message();
    turn.take_bytes(frame.size());
    dialled->incomplete.add(frame.size());
    if (frame.more()) {
      dialled->incomplete.add_on_wire(dialled->socket->skip_rest(frame));
      shell_.count("refused.malformed");
      continue;
    }
    on_frame(link, frame);
  }
}

void DialledLinks::look(const LookPart& part) {
  for (const LinkId link : dialled_.look(part)) drain(link);
}

void DialledLinks::on_empty(LinkId link, Dialled& dialled) {
  if (!dialled_.ends_incomplete(dialled)) return;
  Effects effects;
  shell_.core().links().on_incomplete(link, read_clocks(), effects);
  shell_.carry_out(effects);
}

void DialledLinks::on_frame(LinkId link, Frame& frame) {
  const auto header = decode_frame(view_of(frame));
  if (!header) return on_undecoded(link, frame, header.error());
  if (header->link != link) return shell_.count("refused.malformed");
  forwarder_.from_link(link, *header, frame);
}

/// A frame that cannot be decoded, perhaps because it has another version of the wire.
void DialledLinks::on_undecoded(LinkId link, const Frame& frame, const Error& error) {
  const auto other = decode_frame_of_any_version(view_of(frame));
  const Link* known = std::as_const(shell_.core()).table().link(link);
  const bool answers_hello = known != nullptr && !known->up;
  Effects effects;
  if (error.code != Errc::version_mismatch || !other || !answers_hello) {
    shell_.core().links().on_bad_frame(link, error, read_clocks(), effects);
  } else {
    shell_.core().handshake().on_other_version(link, Bytes(known->key), wire_version(view_of(frame)), *other,
                                               read_clocks(), effects);
  }
  shell_.carry_out(effects);
}

}  // namespace trb::router
