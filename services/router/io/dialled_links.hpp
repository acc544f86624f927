// The links that this node has dialled: a DEALER for each.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "services/router/io/dialled_sockets.hpp"
#include "services/router/io/resolver.hpp"
#include "services/router/io/shared_queue.hpp"

namespace trb::router {

class FrameForwarder;

/// One connection is one link; libzmq never reconnects by itself. A seed's name is looked up beside the loop.
class DialledLinks {
 public:
  DialledLinks(ShellContext& shell, FrameForwarder& forwarder, CurveKeys keys);

  /// A link-local address is reached by the interface `scope`. The core is notified when the dial ends. False: no
  /// descriptor was left to begin with; this was counted and logged.
  bool dial(const Dial& dial, const std::string& scope);
  void close(LinkId link);
  /// Now and then, at a part of the links: ends those on which messages without a last part pile up.
  void look(const LookPart& part);
  [[nodiscard]] std::size_t connections() const { return dialled_.size(); }
  /// Between turns.
  void free_closed() { dialled_.free_closed(); }

  /// Nothing if no such link was dialled.
  [[nodiscard]] std::optional<bool> has_room(LinkId link, std::size_t bytes) const;
  /// The same for a frame of this peer that this node relays.
  [[nodiscard]] std::optional<bool> has_share(LinkId link, std::string_view peer, std::size_t bytes);
  /// `peer`: whose frame this node relays.
  std::optional<SendResult> send(LinkId link, Frame&& frame, std::string_view peer = {});

 private:
  struct Dialled : DialledSocket {
    std::unique_ptr<SharedQueue> queue;
    std::string name;  ///< of a seed that was resolved
  };

  bool dial_numbers(const Dial& dial, const std::string& scope, const std::string& name);
  Status open(const Dial& dial, const std::string& scope, const std::string& name);
  void on_event(LinkId link, LinkEvent event, int fd);
  void on_empty(LinkId link, Dialled& dialled);
  void drain(LinkId link);
  void on_frame(LinkId link, Frame& frame);
  void on_undecoded(LinkId link, const Frame& frame, const Error& error);

  ShellContext& shell_;
  FrameForwarder& forwarder_;
  CurveKeys keys_;
  Resolver resolver_;
  DialledSockets<Dialled> dialled_;
};

}  // namespace trb::router
