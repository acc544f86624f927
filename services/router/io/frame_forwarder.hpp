// Carries a frame from the socket on which it arrived to where the core's orders send it.
#pragma once

#include <optional>

#include "services/router/core/forwarding.hpp"
#include "services/router/io/bus_sockets.hpp"
#include "services/router/io/held_frames.hpp"
#include "services/router/io/lane_sockets.hpp"
#include "services/router/io/link_sender.hpp"
#include "services/router/io/proof_recorder.hpp"
#include "services/router/io/tap.hpp"

namespace trb::router {

/// Each call enters the core once. The frame itself is moved; only additional receivers get copies.
class FrameForwarder {
 public:
  struct To {
    Tap& tap;
    BusSockets& bus;
    LinkSender& links;
    LaneSockets& lanes;
    HeldFrames& held;
    ProofRecorder& proof;
  };
  FrameForwarder(ShellContext& shell, const To& to) : shell_(shell), to_(to) {}

  /// From a service or probe that the core knows.
  void from_bus(ConnectionId from, const HeaderView& as_sent, Frame& frame);
  /// From the link's own connection.
  void from_link(LinkId link, const HeaderView& as_sent, Frame& frame);
  /// The first frame of a connection at the inbox, which has this key; the caller carries out the effects.
  void from_stranger(BytesView key, const HeaderView& header, const Frame& frame, Effects& effects);
  /// From the lane that was dialled for this link.
  void from_lane(LinkId link, Frame& frame);
  /// Reports the links that were found gone to the core.
  void report_lost_links();

 private:
  [[nodiscard]] std::optional<HeaderView> aged(const HeaderView& header, Now now) const;
  void send(ConnectionId from, const HeaderView& header, const FrameOrders& orders, Frame& frame, Effects& effects);
  void send_copy(const Routing& way, const Frame& frame);
  void deliver(LinkId link, const HeaderView& header, Frame& frame, const FrameOrders& orders, Effects& effects);
  SendResult deliver_one(LinkId link, const HeaderView& header, bool hold, ConnectionId to, Frame&& frame);

  ShellContext& shell_;
  To to_;
};

}  // namespace trb::router
