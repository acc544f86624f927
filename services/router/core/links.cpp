// Links: dialled, admitted, heard, dropped and dialled again.
#include <algorithm>

#include "common/base/hex.hpp"
#include "common/security/revocations.hpp"
#include "services/router/core/router_core.hpp"

namespace trb::router {

void RouterCore::dial(Redial& redial, const std::string& address, BytesView key, Now now, Effects& out) {
  Link link;
  link.id = random_u64();
  link.dialled = true;
  link.key = key;
  link.address = address;
  link.opened = now.mono;
  link.last_heard = now.mono;
  redial.at.reset();
  redial.link = link.id;
  out.add(Dial{link.id, address, link.key});
  links_.emplace(link.id, std::move(link));
}

/// One dialling at a time for a key: a seed and a beacon may name the same node.
bool RouterCore::dialling(BytesView key) const {
  return std::any_of(links_.begin(), links_.end(),
                     [&](const auto& row) { return row.second.dialled && !row.second.up && row.second.key == key; });
}

void RouterCore::redial_later(Redial& redial, Now now, Duration at_least) {
  redial.link = 0;
  redial.wait =
      redial.wait == Duration{} ? config_.timing.redial_first : std::min(redial.wait * 2, config_.timing.redial_most);
  redial.at = now.mono + std::max(redial.wait, at_least);
}

void RouterCore::redial_failed(LinkId id, Now now) {
  for (Seed& seed : seeds_) {
    if (seed.redial.link != id) continue;
    const bool patient = seed.hint && seed.redial.wait >= config_.timing.redial_most;
    redial_later(seed.redial, now, patient ? kHintPause : Duration{});
  }
  for (auto& [name, peer] : peers_) {
    if (peer.redial.link == id) {
      const bool patient = relay_of(peer) != nullptr && peer.redial.wait >= config_.timing.redial_most;
      redial_later(peer.redial, now, patient ? kViaPause : Duration{});
    }
  }
}

void RouterCore::on_dial_connected(LinkId id, Now now, Effects& out) {
  if (const auto at = links_.find(id); at != links_.end()) send_hello(at->second, now, out);
}

void RouterCore::link_send(Link& link, const Body& body, Effects& out, const Message* asked) {
  const std::string& target = asked != nullptr ? asked->source : link.peer;
  if (auto message = make_own(target, asked != nullptr ? asked->id : 0, body, out)) {
    if (asked != nullptr && asked->subtype != EchoRequest::kSubtype)
      peers_.at(link.peer).answers.spend(message->data.size());
    out.add(LinkSend{link.id, std::move(*message)});
  }
}

bool RouterCore::admit(BytesView key, MonotonicTime now, Effects& out) {
  if (key == config_.own.link_key.bytes || refuse_revoked_key(key, now, out)) return false;
  // One that is revoked knows that no Hello of its own is taken; one that has only ended may be brought its renewal.
  if (find_revocation(news_.list, config_.own) != nullptr) return false;
  if (const auto at = noisy_.find(key); at != noisy_.end() && now < at->second) {
    out.count("refused.noisy_key");
    return false;
  }
  // Members, and those whom node.json names though they were never met: no crowd of strangers keeps them out.
  if (is_expected(key)) {
    if (const auto name = peers_by_key_.find(key); name != peers_by_key_.end())
      peers_.at(name->second).comes_until = now + config_.timing.handshake;
    return true;
  }
  if (const auto at = denied_.find(key); at != denied_.end() && now < at->second) {
    out.count("refused.denied_key");
    out.log(LogLevel::warning, "denied_key", "the key " + to_hex(key) + " was refused a moment ago");
    return false;
  }
  if (candidates_.count(key) == 0 && candidates_.size() >= kMaxCandidates) {
    out.count("refused.too_many_candidates");
    out.log(LogLevel::warning, "too_many_candidates", "no room for the unknown key " + to_hex(key));
    return false;
  }
  // Connecting again buys no more time.
  if (candidates_.emplace(Bytes(key), now + config_.timing.handshake).second) out.count("candidates");
  return true;
}

void RouterCore::on_link_message(LinkId id, BytesView key, const Message& message, std::uint64_t sequence, Now now,
                                 Effects& out) {
  const auto at = links_.find(id);
  if (at != links_.end() && !key.empty() && key != at->second.key) {
    out.count("refused.link_theft");
    return out.log(LogLevel::warning, "link_theft", "a connection used another one's link id");
  }
  if (at == links_.end() && refuse_revoked_key(key, now.mono, out)) return;
  const auto denied = denied_.find(key);
  if (at == links_.end() && peers_by_key_.count(key) == 0 && denied != denied_.end() && now.mono < denied->second)
    return out.count("refused.denied_key");
  if (message.subtype == Hello::kSubtype) return on_hello(id, key, message, sequence, now, out);
  if (at == links_.end() || !at->second.up) return on_early_message(id, key, message, now, out);
  on_peer_message(at->second, message, now, out);
}

void RouterCore::on_early_message(LinkId id, BytesView key, const Message& message, Now now, Effects& out) {
  if (const auto at = links_.find(id); at != links_.end()) {
    // What it says before its Goodbye may be what this node has to know: its own renewed certificate.
    if (message.subtype == FleetNews::kSubtype) return on_news_message(at->second, message, now, out);
    // Dialled, and answered by something else than Hello: the other side refuses.
    auto goodbye = decode<Goodbye>(message.data);
    const bool said = message.subtype == Goodbye::kSubtype && goodbye;
    out.count("dial.refused");
    note_trouble(id, said ? "refused_us" : "no_hello", said ? goodbye->reason : "answered without Hello", now);
    return drop_link(id, said ? "refused: " + goodbye->reason : "answered without Hello", false, now, out);
  }
  // A member's may have been under way when its link was closed; a stranger's first word must be Hello.
  if (peers_by_key_.count(key) != 0) return out.count("dropped.closed_link");
  refuse_candidate(id, key, fail(Errc::unknown_peer_key, "a connection without a certificate sent " + message.subtype),
                   now, out);
}

void RouterCore::on_peer_message(Link& link, const Message& message, Now now, Effects& out) {
  if (message.subtype == FleetNews::kSubtype) return on_news_message(link, message, now, out);
  if (message.subtype == NodeProfile::kSubtype) return take_profile(peers_.at(link.peer), message.data, now, out);
  auto body = decode_body(message.subtype, message.data);
  if (!body) return deny_peer(link, message, body.error(), out);
  if (const auto* seal = get_if<Seal>(&*body)) return on_seal(link, *seal, now, out);
  if (const auto* alive = get_if<KeepAlive>(&*body)) return on_keep_alive(link, *alive, now);
  if (const auto* told = get_if<Neighbours>(&*body)) {
    on_neighbours(link, *told, now, out);
  } else if (const auto* relayed = get_if<Relayed>(&*body)) {
    on_relayed(link, message, *relayed, now, out);
  } else if (const auto* refused = get_if<RelayRefused>(&*body)) {
    on_relay_refused(link, *refused, out);
  } else if (const auto* goodbye = get_if<Goodbye>(&*body)) {
    if (goodbye->reason == kUnheard)
      note_trouble(link.id, "one_way", "it does not hear this node, which hears it", now);
    drop_link(link.id, "the other side said goodbye: " + goodbye->reason, false, now, out);
  } else if (auto reply = answer_peer(peers_.at(link.peer), message, now)) {
    link_send(link, *reply, out, &message);
  } else {
    const bool full = reply.error().code == Errc::queue_full;
    deny_peer(link, message, full ? reply.error() : fail(Errc::not_permitted, reply.error().what), out);
  }
}

void RouterCore::deny_peer(Link& link, const Message& message, const Error& error, Effects& out) {
  out.count("refused." + std::string(errc_name(error.code)));
  out.log(LogLevel::warning, "message_refused", link.peer + " sent " + message.subtype + ": " + error.text());
  if (message.type == MessageType::information || message.reply_to != 0) return;
  const Nack nack{std::string(errc_name(error.code)), message.subtype, message.target, error.what, error.cure};
  link_send(link, nack, out, &message);
}

void RouterCore::on_keep_alive(Link& link, const KeepAlive& body, Now now) {
  while (!link.unconfirmed.empty() && link.unconfirmed.front() <= body.heard) {
    link.unconfirmed.pop_front();
    link.confirmed = now.mono;
  }
}

void RouterCore::drop_link(LinkId id, const std::string& why, bool say_goodbye, Now now, Effects& out) {
  const auto at = links_.find(id);
  if (at == links_.end()) return;
  Link& link = at->second;
  const bool carried = link.up && peers_.count(link.peer) != 0 && peers_.at(link.peer).link == id;
  if (link.up) tell_unsealed(id, link.peer, out);
  if (link.up && holds(id)) out.add(ReturnHeld{id, link.peer, why, say_goodbye});
  if (say_goodbye && link.up) last_seal(id, out);
  if (say_goodbye && link.up) link_send(link, Goodbye{why.substr(0, 128)}, out);
  // A node that is off is dialled for ever: names apart, so that its lines do not use up what may be logged of real
  // ends.
  out.log(LogLevel::info, link.up ? "link_closed" : "dial_ended",
          (link.peer.empty() ? "unproven" : link.peer) + ": " + why);
  out.add(CloseLink{id});
  const std::string name = link.peer;
  const Link gone = link;
  links_.erase(at);
  redial_failed(id, now);
  if (!carried) return;
  Peer& peer = peers_.at(name);
  peer.link = 0;
  // The lease runs from the last sign of life, not from when its end was noticed.
  peer.lost = std::min(gone.last_heard, gone.confirmed);
  peer.last_heard = gone.last_heard;
  if (carrier_of(peer) != nullptr) peer.road.begin(now.mono);
  neighbour_changed(name, now);
  relay_lost(gone, out);
  // Both may dial again; the greater id gives the smaller a head start.
  redial_later(peer.redial, now, own_is_smaller(name) ? Duration{} : config_.timing.yield);
}

void RouterCore::on_bad_frame(LinkId id, const Error& error, Now now, Effects& out) {
  const std::string code(errc_name(error.code));
  out.count("refused." + code);
  out.log(LogLevel::warning, "frame_refused", error.text());
  note_trouble(id, code, error.what, now);
  drop_link(id, "sent a frame that is none: " + code, true, now, out);
}

void RouterCore::on_link_ended(LinkId id, LinkEnd how, Now now, Effects& out) {
  const auto at = links_.find(id);
  if (at == links_.end()) return;
  if (how != LinkEnd::failed && how != LinkEnd::disconnected) out.count("dial." + std::string(name_of(how)));
  if (!at->second.up) note_trouble(id, name_of(how), "the dial ended before a Hello was heard", now);
  drop_link(id, std::string(name_of(how)), false, now, out);
}

}  // namespace trb::router
