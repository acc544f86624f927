// The lossy lane: who hears this node's, where the others' are dialled, what is taken from them.
#include "services/router/core/lane.hpp"

#include <algorithm>

#include "common/base/address.hpp"
#include "common/security/rights.hpp"
#include "services/router/core/router_core.hpp"

namespace trb::router {
namespace {

Routing drop(Errc reason) {
  return {.reason = reason};
}

/// The other side's lane: what it dialled is reached where this node has reached it, whatever it calls itself.
std::string lane_address(const Link& link, const Hello& hello) {
  if (hello.lane.empty() || !link.dialled || !is_numeric_endpoint(link.address)) return hello.lane;
  const auto port = hello.lane.rfind(':');
  return link.address.substr(0, link.address.rfind(':')) + (port == std::string::npos ? "" : hello.lane.substr(port));
}

}  // namespace

bool Spare::take(std::size_t size, MonotonicTime now) {
  if (now >= end_) {
    messages_ = 0;
    bytes_ = 0;
    end_ = now + std::chrono::seconds(1);
  }
  if (messages_ >= kMessages || bytes_ + size > kBytes) return false;
  ++messages_;
  bytes_ += size;
  return true;
}

// ---- the other side's lane, dialled

void RouterCore::find_lane(Link& link, const Hello& hello, Now now) {
  link.lane.address = lane_address(link, hello);
  if (!link.lane.address.empty()) link.lane.dial_at = now.mono + kLaneAfter;
}

void RouterCore::tick_lanes(Now now, Effects& out) {
  for (auto& [id, link] : links_) {
    if (!link.lane.dial_at || now.mono < *link.lane.dial_at) continue;
    link.lane.dial_at.reset();
    out.add(DialLane{id, link.lane.address, link.key});
  }
}

void RouterCore::on_lane_connected(LinkId id, Now now) {
  if (const auto at = links_.find(id); at != links_.end()) at->second.lane.connected = now.mono;
}

void RouterCore::on_lane_ended(LinkId id, LinkEnd how, Now now, Effects& out) {
  const auto at = links_.find(id);
  if (at == links_.end()) return;
  Lane& lane = at->second.lane;
  out.count("lane." + std::string(name_of(how)));
  // One that is cut again and again is dialled ever less often.
  if (lane.connected && now.mono - *lane.connected > config_.timing.lease) lane.wait = {};
  lane.connected.reset();
  lane.wait = std::clamp(lane.wait * 2, kLaneFirst, kLaneMost);
  lane.dial_at = now.mono + lane.wait;
}

Routing RouterCore::route_lane(LinkId id, const HeaderView& header, Effects& out) const {
  const Link* link = find_link(id);
  if (link == nullptr || !link->up) return drop(Errc::unknown_peer_key);
  const auto refuse = [&](Errc reason, std::string_view name) {
    out.count("refused.lane_" + std::string(name));
    out.log(LogLevel::warning, "lane_" + std::string(name),
            link->peer + " sent " + std::string(header.subtype) + " of '" + std::string(header.source) + "' for '" +
                std::string(header.target) + "' by its lane");
    return drop(reason);
  };
  if (!is_lossy(header)) return refuse(Errc::bad_value, "not_lossy");
  if (header.source != link->peer) return refuse(Errc::source_mismatch, "source_mismatch");
  if (header.target != config_.id && header.target != kEveryNode) return refuse(Errc::unknown_target, "wrong_target");
  // The words of a link have no meaning here, nor what a node keeps to itself.
  if (!may_send_out(peers_.at(link->peer).certificate.role, header.subtype))
    return refuse(Errc::not_permitted, "not_permitted");
  const Routing own = header.remaining_ms == 0 ? drop(Errc::expired) : route_from(peers_.at(link->peer), header, out);
  if (own.to == Routing::To::router) return refuse(Errc::not_permitted, "not_permitted");
  if (own.to == Routing::To::drop)
    out.count((own.reason == Errc::not_asked ? "refused." : "dropped.") + std::string(errc_name(own.reason)));
  return own;
}

// ---- this node's lane

/// The peer with this key whose link is up.
Link* RouterCore::linked_by_key(BytesView key) {
  const auto name = peers_by_key_.find(key);
  const auto peer = name == peers_by_key_.end() ? peers_.end() : peers_.find(name->second);
  const auto link = peer == peers_.end() ? links_.end() : links_.find(peer->second.link);
  return link == links_.end() ? nullptr : &link->second;
}

bool RouterCore::admit_to_lane(BytesView key, Effects& out) {
  const Link* link = linked_by_key(key);
  if (link != nullptr && !link->lane.barred) return true;
  out.count("refused.lane_key");
  return false;
}

std::optional<LinkId> RouterCore::on_listen(BytesView key, BytesView topic, Effects& out) {
  Link* link = linked_by_key(key);
  if (link == nullptr || link->lane.barred) {
    out.count("refused.lane_key");
    return std::nullopt;
  }
  if (topic != topic_of(link->peer)) {
    out.count("refused.lane_topic");
    out.log(LogLevel::warning, "lane_topic", link->peer + " wants to hear what is not meant for it");
    return std::nullopt;
  }
  link->lane.listens = true;
  return link->id;
}

void RouterCore::on_listener_gone(LinkId id) {
  if (const auto at = links_.find(id); at != links_.end()) at->second.lane.listens = false;
}

void RouterCore::bar_from_lane(BytesView key, Effects& out) {
  out.count("refused.lane_word");
  Link* link = linked_by_key(key);
  if (link == nullptr) return;
  link->lane.barred = true;
  link->lane.listens = false;
  out.log(LogLevel::warning, "lane_word",
          link->peer + " said something to the lane, which is for listening: kept out of it until its link has ended");
}

Routing RouterCore::by_lane(std::string_view to, std::size_t size, Now now) {
  const auto at = peers_.find(to);
  if (at == peers_.end()) return drop(Errc::unknown_target);
  Peer& peer = at->second;
  const Link* link = find_link(peer.link);
  if (link != nullptr && link->lane.listens) return {.to = Routing::To::lane, .link = link->id};
  const Link* relay = link == nullptr ? relay_of(peer) : nullptr;
  if (link == nullptr && relay == nullptr) return drop(Errc::peer_unreachable);
  if (!peer.spare.take(size, now.mono)) {
    count("dropped.no_lane");
    return drop(Errc::queue_full);
  }
  if (link != nullptr) return {.to = Routing::To::peer, .link = link->id};
  return {.to = Routing::To::relay, .link = relay->id};
}

}  // namespace trb::router
