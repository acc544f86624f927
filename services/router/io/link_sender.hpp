// Sends frames by the links, accepted and dialled, with their seals.
#pragma once

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "services/router/io/dialled_links.hpp"
#include "services/router/io/inbox_socket.hpp"
#include "services/router/io/tap.hpp"

namespace trb::router {

/// Sends frames and seals in the seal book's order, and keeps what could not be sent until the shell has notified the
/// core.
class LinkSender {
 public:
  LinkSender(ShellContext& shell, Tap& tap, InboxSocket& inbox, DialledLinks& dialled);

  /// Is there room for a frame of this size? For small ones always.
  [[nodiscard]] bool has_room(LinkId link, std::size_t bytes) const;
  /// Numbers the frame now. `peer`: whose frame this node relays, who has a share of the link's queue.
  SendResult send(LinkId link, Frame&& frame, std::string_view peer = {});
  /// The frame is numbered already; its seals go with it.
  SendResult send(LinkId link, const Outgoing& outgoing, Frame&& frame, std::string_view peer = {});
  /// A message that the router made or, of `peer`, passes on; if it did not leave, take_unsent() returns it.
  void send_own(LinkId link, Message message, BytesView frame, std::string_view peer = {});
  /// Seals what is unsealed on this link now.
  void send_seal(LinkId link);

  /// This link's connection is gone: the shell takes it later and notifies the core.
  void lose(LinkId link) { lost_.push_back(link); }
  /// The last lost link that was not taken yet.
  std::optional<LinkId> take_lost();
  std::vector<std::pair<Message, Errc>> take_unsent() { return std::exchange(unsent_, {}); }

 private:
  bool has_share(LinkId link, std::string_view peer, std::size_t bytes);
  SendResult put(LinkId link, Frame&& frame, std::string_view peer = {});
  SendResult put_seal(LinkId link, BytesView seal);

  ShellContext& shell_;
  Tap& tap_;
  InboxSocket& inbox_;
  DialledLinks& dialled_;
  std::vector<LinkId> lost_;
  std::vector<std::pair<Message, Errc>> unsent_;  ///< of the router itself
};

}  // namespace trb::router
