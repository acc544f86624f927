#include "services/router/core/reachable_peers.hpp"

#include <utility>

namespace trb::router {
namespace {

constexpr Duration kGather = std::chrono::milliseconds(100);
constexpr std::size_t kMostAtOnce = 64;

}  // namespace

void ReachablePeers::on_change(const std::string& peer, Now now) {
  if (!node_.relays()) return;
  changed_.insert(peer);
  next_ = earlier(next_, now.mono + kGather);
}

void ReachablePeers::notify(const Link& to, const std::set<std::string>& about, Effects& out) {
  ReachablePeerList part;
  const auto send = [&] {
    if (!part.reached.empty() || !part.gone.empty()) messages_.send(to, part, out);
    part = {};
  };
  for (const std::string& id : about) {
    if (id == to.peer) continue;
    const Peer* peer = table_.find(id);
    if (peer != nullptr && peer->link != 0) {
      part.reached.push_back(peer->certificate_record);
    } else {
      part.gone.push_back(id);
    }
    if (part.reached.size() >= kMostAtOnce || part.gone.size() >= kMostAtOnce) send();
  }
  send();
}

void ReachablePeers::notify_all(const Link& to, Effects& out) {
  if (!node_.relays()) return;
  std::set<std::string> all;
  for (const auto& [id, peer] : table_.peers()) {
    if (peer.link != 0) all.insert(id);
  }
  notify(to, all, out);
}

void ReachablePeers::notify_anew(const Link& to, Effects& out) {
  if (!node_.relays()) return;
  std::set<std::string> all;
  for (const auto& [id, peer] : table_.peers()) all.insert(id);
  notify(to, all, out);
}

void ReachablePeers::tick(Now now, Effects& out) {
  if (!next_ || now.mono < *next_) return;
  next_.reset();
  const auto changed = std::exchange(changed_, {});
  for (const LinkId id : table_.up_links()) notify(*table_.link(id), changed, out);
}

/// A link may bring only its own peer's frames to be passed on. Their contents are encrypted for the target.
void ReachablePeers::pass_on(const Link& link, const Message& message, const Relayed& body, const RelayedFrame& inner,
                             Now now, Effects& out) {
  if (!node_.relays())
    return refuse_relayed(link, "no_relay", "for '" + inner.target + "': this node is no relay", out);
  if (body.record.signer != link.peer)
    return refuse_relayed(link, "second_hop", "signed by '" + body.record.signer + "'", out);
  const Peer* target = table_.find(inner.target);
  if (target == nullptr || target->link == 0) {
    const Errc reason = target == nullptr ? Errc::unknown_target : Errc::peer_unreachable;
    out.count("dropped." + std::string(errc_name(reason)));
    return refuse(link, inner, reason, out);
  }
  if (Peer* source = table_.find(link.peer); source != nullptr && !source->carried.take(now.mono)) {
    out.count("dropped.relayed_too_many");
    return refuse(link, inner, Errc::queue_full, out);
  }
  out.count("relayed.sent");
  Message passed = message;
  passed.source = node_.id();
  passed.target = inner.target;
  passed.id = messages_.next_id();
  out.add(LinkSend{target->link, std::move(passed), link.peer});
}

void ReachablePeers::refuse(const Link& to, const RelayedFrame& inner, Errc reason, Effects& out) {
  messages_.send(to, RelayRefused{inner.target, inner.count, std::string(errc_name(reason))}, out);
}

void refuse_relayed(const Link& relay, std::string_view reason, const std::string& text, Effects& out) {
  out.count("refused.relayed_" + std::string(reason));
  out.log(LogLevel::warning, "relayed_refused", "by " + relay.peer + ": " + text);
}

}  // namespace trb::router
