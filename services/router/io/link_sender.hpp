// What leaves by the links, accepted and dialled, with its seals.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "services/router/io/dialled_links.hpp"
#include "services/router/io/inbox_socket.hpp"
#include "services/router/io/tap.hpp"

namespace trb::router {

/// Sends frames and seals in the order that the seal book wants, and keeps what could not be sent until the shell has
/// told the core.
class LinkSender {
 public:
  LinkSender(ShellContext& shell, Tap& tap, InboxSocket& inbox, DialledLinks& dialled);

  /// For a frame of so many bytes; small ones always have it.
  [[nodiscard]] bool has_room(LinkId link, std::size_t bytes) const;
  /// A frame that is numbered now.
  SendResult send(LinkId link, Frame&& frame);
  /// A frame that is numbered, with its seals.
  SendResult send(LinkId link, const Outgoing& outgoing, Frame&& frame);
  /// A message of the router's own; it is in take_unsent() if it did not leave.
  void send_own(LinkId link, Message message, BytesView frame);
  /// What is unsealed on this link is sealed now.
  void send_seal(LinkId link);

  /// This link's connection is gone: the core is told when the shell takes it.
  void lose(LinkId link) { lost_.push_back(link); }
  /// The last one that is lost and was not taken.
  std::optional<LinkId> take_lost();
  std::vector<std::pair<Message, Errc>> take_unsent() { return std::exchange(unsent_, {}); }

 private:
  SendResult put(LinkId link, Frame&& frame);
  SendResult put_seal(LinkId link, BytesView seal);

  ShellContext& shell_;
  Tap& tap_;
  InboxSocket& inbox_;
  DialledLinks& dialled_;
  std::vector<LinkId> lost_;
  std::vector<std::pair<Message, Errc>> unsent_;  ///< of the router itself
};

}  // namespace trb::router
