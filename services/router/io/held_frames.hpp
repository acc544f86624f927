// Frames that wait until the seal over them is checked (seal_before_delivery).
#pragma once

#include <deque>
#include <map>

#include "services/router/io/bus_sockets.hpp"

namespace trb::router {

/// Per link, in the order of arrival, kMaxUnsealed frames and kMaxHeldBytes at most: SealBook::receive ends a link that
/// has more.
class HeldFrames {
 public:
  HeldFrames(ShellContext& shell, BusSockets& bus) : shell_(shell), bus_(bus) {}

  void hold(LinkId link, std::uint64_t sequence, ConnectionId to, Frame&& frame);
  /// Sends the proven frames to their services.
  void deliver(const DeliverHeld& proven);
  /// Drops all frames of the link; the core Nacks them if it can.
  void give_back(const ReturnHeld& of);
  void close_link(LinkId link) { held_.erase(link); }

 private:
  struct Held {
    std::uint64_t sequence = 0;
    ConnectionId to = 0;
    Frame frame;
  };
  void deliver(LinkId link, Held held);

  ShellContext& shell_;
  BusSockets& bus_;
  std::map<LinkId, std::deque<Held>> held_;
};

}  // namespace trb::router
