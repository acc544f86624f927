// The inbox: the links that other nodes have dialled, and connections that want to become one.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "services/router/io/inbox_guard.hpp"
#include "services/router/io/shared_queue.hpp"
#include "services/router/io/shell_context.hpp"

namespace trb::router {

class FrameForwarder;

/// frame of                     | what follows
/// -----------------------------|---------------------------------------------------------------------------------
/// an accepted link's connection| to the forwarder, as the link's
/// a connection without a link  | to the forwarder, as a stranger's: accept() or refuse() may follow meanwhile
/// another link's connection    | refused.link_theft; a second Hello: Links::on_second_link
/// another version of the wire  | to Handshake, if it is the connection's first; else a bad frame of the link
class InboxSocket {
 public:
  InboxSocket(ShellContext& shell, FrameForwarder& forwarder, CurveKeys keys, const PendingConnectionLimits& limits);

  /// Opens it at this endpoint; empty: nowhere yet. Every other connection ends. Errors: io_error (naming the address;
  /// no descriptor is left); then there is no inbox until the next call.
  Status open(const std::string& endpoint);
  void close();
  [[nodiscard]] bool is_open() const { return socket_.has_value(); }
  /// Binds a second endpoint while it is open. Errors: io_error naming it.
  Status bind(const std::string& endpoint);
  void unbind(const std::string& endpoint) { socket_->unbind(endpoint); }

  /// The connection whose frame is being handled is this link from now on.
  void accept(LinkId link);
  /// Sends this Goodbye and cuts the connection; does nothing while no connection's frame is being handled.
  void refuse(const RefuseCandidate& refuse);
  /// The link has ended: cuts its connection after a delay, so that the last message can be read.
  void close_link(LinkId link);
  /// Now and then, at a part of the connections: ends those on which messages without a last part pile up.
  void look(const LookPart& part);
  [[nodiscard]] std::size_t connections() const { return guard_.connections(); }

  /// Nothing if no such link was accepted here.
  [[nodiscard]] std::optional<bool> has_room(LinkId link, std::size_t bytes) const;
  /// The same for a frame of this peer that this node relays.
  [[nodiscard]] std::optional<bool> has_share(LinkId link, std::string_view peer, std::size_t bytes);
  /// `unroutable`: there is no such link, or its connection is gone. `peer`: whose frame this node relays.
  SendResult send(LinkId link, Frame&& frame, std::string_view peer = {});

 private:
  struct Accepted {
    Bytes routing_id;
    Bytes user;  ///< User-Id: the key, in hexadecimal
    PendingConnectionId pending = 0;
    std::unique_ptr<SharedQueue> queue;
    std::shared_ptr<IncompleteBytes> incomplete;
  };
  /// Where the frame now being handled came from, for accept() and refuse().
  struct Origin {
    Bytes routing_id;
    Bytes user;
    PendingConnectionId pending = 0;
  };

  void drain();
  void on_incomplete(PendingConnectionId pending, const std::string& address);
  void on_parts(BytesView routing_id, const Frame& first);
  Accepted* sender(BytesView routing_id, const Frame& frame);
  void on_frame(BytesView routing_id, Frame& frame);
  void on_undecoded(BytesView routing_id, const Frame& frame, const Error& error);
  void on_other_version(BytesView routing_id, const Frame& frame);
  void on_unproven(BytesView routing_id, const HeaderView& header, const Frame& frame);
  void on_later_frame(Effects& effects);
  void on_bad_frame(LinkId link, const Error& error);
  PendingConnectionId pending_of(const Frame& frame);
  [[nodiscard]] bool is_undecided(const Frame& frame) const { return guard_.is_undecided(connection_fd(frame)); }
  void on_event(LinkEvent event, int fd);
  void refused(const char* name, const char* text);

  ShellContext& shell_;
  FrameForwarder& forwarder_;
  CurveKeys keys_;
  InboxGuard guard_;
  std::optional<Socket> socket_;
  std::unique_ptr<SocketMonitor> monitor_;
  std::map<LinkId, Accepted> accepted_;
  Origin origin_;
};

}  // namespace trb::router
