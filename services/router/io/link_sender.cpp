#include "services/router/io/link_sender.hpp"

#include "services/router/io/send_errors.hpp"

namespace trb::router {

LinkSender::LinkSender(ShellContext& shell, Tap& tap, InboxSocket& inbox, DialledLinks& dialled)
    : shell_(shell), tap_(tap), inbox_(inbox), dialled_(dialled) {}

bool LinkSender::has_room(LinkId link, std::size_t bytes) const {
  if (bytes < kCountedFrame) return true;
  if (const auto room = dialled_.has_room(link, bytes)) return *room;
  return inbox_.has_room(link, bytes).value_or(true);
}

bool LinkSender::has_share(LinkId link, std::string_view peer, std::size_t bytes) {
  if (peer.empty()) return true;
  if (const auto share = dialled_.has_share(link, peer, bytes)) return *share;
  return inbox_.has_share(link, peer, bytes).value_or(true);
}

SendResult LinkSender::send(LinkId link, Frame&& frame, std::string_view peer) {
  if (!has_room(link, frame.size())) return SendResult::full;
  if (!has_share(link, peer, frame.size())) {
    shell_.count("dropped.peer_share");
    return SendResult::full;
  }
  const Outgoing outgoing =
      shell_.core().seals().send(link, static_cast<char*>(frame.data()), frame.size(), read_clocks());
  return send(link, outgoing, std::move(frame), peer);
}

SendResult LinkSender::send(LinkId link, const Outgoing& outgoing, Frame&& frame, std::string_view peer) {
  if (!outgoing.known) return SendResult::unroutable;
  if (!outgoing.before.empty()) {
    if (const SendResult result = put_seal(link, outgoing.before); result != SendResult::sent) {
      shell_.core().seals().not_sent(link, Unsent::before);
      return result;
    }
  }
  const SendResult result = put(link, std::move(frame), peer);
  if (result != SendResult::sent) {
    shell_.core().seals().not_sent(link, Unsent::frame);
  } else if (!outgoing.behind.empty() && put_seal(link, outgoing.behind) != SendResult::sent) {
    shell_.core().seals().not_sent(link, Unsent::behind);
  }
  return result;
}

void LinkSender::send_own(LinkId link, Message message, BytesView frame, std::string_view peer) {
  tap_.show('>', frame);
  const SendResult result = send(link, to_frame(frame), peer);
  if (result == SendResult::sent) return;
  if (result == SendResult::unroutable) lose(link);
  unsent_.emplace_back(std::move(message), why_unsent(result));
}

void LinkSender::send_seal(LinkId link) {
  const auto seal = shell_.core().seals().make_seal(link, read_clocks());
  if (seal && put_seal(link, *seal) != SendResult::sent) shell_.core().seals().not_sent(link, Unsent::behind);
}

std::optional<LinkId> LinkSender::take_lost() {
  if (lost_.empty()) return std::nullopt;
  const LinkId link = lost_.back();
  lost_.pop_back();
  return link;
}

SendResult LinkSender::put(LinkId link, Frame&& frame, std::string_view peer) {
  if (const auto result = dialled_.send(link, std::move(frame), peer)) return *result;
  // NOLINTNEXTLINE(bugprone-use-after-move): who has no such link has taken nothing
  return inbox_.send(link, std::move(frame), peer);
}

SendResult LinkSender::put_seal(LinkId link, BytesView seal) {
  tap_.show('>', seal);
  const SendResult result = put(link, to_frame(seal));
  if (result == SendResult::unroutable) lose(link);
  return result;
}

}  // namespace trb::router
