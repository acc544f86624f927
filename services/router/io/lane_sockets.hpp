// Lossy information: sent by the own lane, received from the peers' lanes, a SUB for each.
#pragma once

#include <algorithm>
#include <string>

#include "services/router/io/dialled_sockets.hpp"
#include "services/router/io/lane_server.hpp"
#include "services/router/io/shell_options.hpp"

namespace trb::router {

class FrameForwarder;

/// The lanes of this node: its own, and those of the peers, dialled beside each link.
class LaneSockets {
 public:
  LaneSockets(ShellContext& shell, FrameForwarder& forwarder, const ShellOptions& options);

  /// The lane to which others listen.
  [[nodiscard]] LaneServer& own() { return own_; }
  /// To the link's peer; counted as sent or dropped.
  void publish(LinkId link, Frame&& frame);
  /// A link-local address is reached by the interface `scope`. The core is notified when it ends.
  void dial(const DialLane& dial, const std::string& scope);
  /// The link is over: ends its lanes in both directions.
  void close_link(LinkId link);
  /// Now and then, at a part of the lanes: ends those on which messages without a last part pile up.
  void look(const LookPart& part);
  /// Of its own lane or of the others', of which there are more.
  [[nodiscard]] std::size_t connections() const { return std::max(own_.connections(), dialled_.size()); }
  /// Between turns.
  void free_closed() { dialled_.free_closed(); }

 private:
  Status open(const DialLane& dial, const std::string& scope);
  void on_event(LinkId link, LinkEvent event, int fd);
  void ended(LinkId link, LinkEndReason how);
  void drain(LinkId link);
  void on_empty(LinkId link, DialledSocket& dialled);

  ShellContext& shell_;
  FrameForwarder& forwarder_;
  CurveKeys keys_;
  LaneServer own_;
  DialledSockets<DialledSocket> dialled_;
};

}  // namespace trb::router
