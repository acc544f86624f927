// Links: dialled or accepted, proven by certificate and key, one that stays for each pair of nodes.
#include "services/router/core/router_core.hpp"

namespace trb::router {

void RouterCore::dial(Redial& redial, const std::string& address, BytesView key, Now now, Effects& out) {
  Link link;
  link.id = random_u64();
  link.dialled = true;
  link.key = key;
  link.opened = now.mono;
  link.last_heard = now.mono;
  redial.at.reset();
  redial.link = link.id;
  out.add(Dial{link.id, address, link.key});
  links_.emplace(link.id, std::move(link));
}

void RouterCore::redial_later(Redial& redial, Now now, Duration at_least) {
  redial.link = 0;
  redial.wait =
      redial.wait == Duration{} ? config_.timing.redial_first : std::min(redial.wait * 2, config_.timing.redial_most);
  redial.at = now.mono + std::max(redial.wait, at_least);
}

void RouterCore::redial_failed(LinkId id, Now now) {
  for (Seed& seed : seeds_) {
    if (seed.redial.link == id) redial_later(seed.redial, now);
  }
  for (auto& [name, peer] : peers_) {
    if (peer.redial.link == id) redial_later(peer.redial, now);
  }
}

void RouterCore::on_dial_connected(LinkId id, Now now, Effects& out) {
  if (const auto at = links_.find(id); at != links_.end()) send_hello(at->second, now, out);
}

void RouterCore::send_hello(Link& link, Now now, Effects& out) {
  if (link.hello_sent) return;
  link.hello_sent = true;
  const UtcTime utc = checked_utc(now.utc);
  link_send(
      link,
      Hello{config_.certificate, config_.boot, config_.address, config_.version, utc.ns, utc == now.utc, profile_},
      out);
}

void RouterCore::link_send(Link& link, const Body& body, Effects& out, const Message* asked) {
  Message message;
  message.type = MessageType::information;
  message.subtype = subtype_of(body);
  message.source = config_.id;
  message.target = asked != nullptr ? asked->source : link.peer;
  message.id = ++message_count_;
  message.reply_to = asked != nullptr ? asked->id : 0;
  message.data = encode_body(body);
  out.add(LinkSend{link.id, ++link.sent, std::move(message)});
}

bool RouterCore::admit(BytesView key, MonotonicTime now, Effects& out) {
  if (key == config_.own.link_key.bytes) return false;
  if (peers_by_key_.count(key) != 0) return true;
  if (const auto at = denied_.find(key); at != denied_.end() && now < at->second) {
    out.count("refused.denied_key");
    return false;
  }
  if (candidates_.count(key) == 0 && candidates_.size() >= kMaxCandidates) {
    out.count("refused.too_many_candidates");
    return false;
  }
  candidates_[Bytes(key)] = now + config_.timing.handshake;
  out.count("candidates");
  return true;
}

void RouterCore::on_link_message(LinkId id, BytesView key, const Message& message, std::uint64_t sequence, Now now,
                                 Effects& out) {
  const auto at = links_.find(id);
  if (message.subtype == Hello::kSubtype) return on_hello(id, key, message, sequence, now, out);
  if (at == links_.end() || !at->second.up) {
    // A stranger's first word must be Hello; a member's may be one that was under way when its link was closed.
    out.count(peers_by_key_.count(key) != 0 ? "dropped.closed_link" : "refused.unknown_key");
    if (peers_by_key_.count(key) == 0) {
      out.log(LogLevel::warning, "unknown_key", "a connection without a certificate sent " + message.subtype);
      refuse_candidate(id, key, fail(Errc::unknown_peer_key, "say Hello first"), now, out);
    }
    return;
  }
  Link& link = at->second;
  auto body = decode_body(message.subtype, message.data);
  if (!body) {
    out.count("refused.malformed");
    return;
  }
  if (const auto* alive = std::get_if<KeepAlive>(&*body)) return on_keep_alive(link, *alive, now);
  if (const auto* profile = std::get_if<NodeProfile>(&*body)) {
    peers_.at(link.peer).profile = *profile;
  } else if (const auto* goodbye = std::get_if<Goodbye>(&*body)) {
    drop_link(id, "the other side said goodbye: " + goodbye->reason, false, now, out);
  } else if (auto reply = answer_to(message, now)) {
    link_send(link, *reply, out, &message);
  } else {
    out.count("refused.not_permitted");
  }
}

void RouterCore::on_keep_alive(Link& link, const KeepAlive& body, Now now) {
  while (!link.unconfirmed.empty() && link.unconfirmed.front() <= body.heard) {
    link.unconfirmed.pop_front();
    link.confirmed = now.mono;
  }
}

Result<Certificate> RouterCore::check_hello(const Link& link, const Message& message, const Hello& hello,
                                            Now now) const {
  auto certificate = open_certificate(hello.certificate, config_.authority, checked_utc(now.utc));
  if (!certificate) return certificate;
  if (certificate->link_key.bytes != link.key) {
    return fail(Errc::wrong_key,
                "certificate of '" + certificate->id + "' names another link key than the connection's");
  }
  if (message.source != certificate->id) {
    return fail(Errc::source_mismatch,
                "Hello of '" + message.source + "' with the certificate of '" + certificate->id + "'");
  }
  if (certificate->id == config_.id) {
    return fail(Errc::duplicate, "another node is called '" + config_.id + "' too", "give each node its own id");
  }
  const auto known = peers_.find(certificate->id);
  if (known != peers_.end() && known->second.certificate.serial > certificate->serial) {
    return fail(Errc::conflict, "an older certificate of '" + certificate->id + "'",
                "use the one that was signed last");
  }
  if (known != peers_.end() && known->second.boot > hello.boot) {
    return fail(Errc::conflict, "an older boot of '" + certificate->id + "'");
  }
  return certificate;
}

void RouterCore::on_hello(LinkId id, BytesView key, const Message& message, std::uint64_t sequence, Now now,
                          Effects& out) {
  const auto known = links_.find(id);
  const bool dialled = known != links_.end() && known->second.dialled && !known->second.up;
  if (known != links_.end() && !dialled) {
    out.count("refused.repeated_hello");
    return;
  }
  Link fresh;
  fresh.id = id;
  fresh.key = key;
  fresh.opened = now.mono;
  const Link& tried = dialled ? known->second : fresh;
  auto hello = message.data.size() > kMaxHelloSize && candidates_.count(key) != 0
                   ? Result<Hello>(fail(Errc::too_large, "Hello over 4 kB"))
                   : decode<Hello>(message.data);
  auto certificate = hello ? check_hello(tried, message, *hello, now) : Result<Certificate>(hello.error());
  if (!certificate) {
    if (dialled) return drop_link(id, certificate.error().text(), false, now, out);
    return refuse_candidate(id, key, certificate.error(), now, out);
  }
  candidates_.erase(Bytes(key));
  if (!dialled) {
    links_.emplace(id, fresh);
    out.add(AcceptLink{id});
  }
  Link& link = links_.at(id);
  link.heard = sequence;
  make_peer(*certificate, hello->certificate);
  link_up(link, *certificate, *hello, now, out);
}

Peer& RouterCore::make_peer(const Certificate& certificate, const SignedRecord& record) {
  Peer& peer = peers_[certificate.id];
  if (!peer.certificate.link_key.bytes.empty() && peer.certificate.link_key != certificate.link_key) {
    peers_by_key_.erase(peer.certificate.link_key.bytes);
  }
  peer.id = certificate.id;
  peer.certificate = certificate;
  peer.certificate_record = record;
  peers_by_key_[certificate.link_key.bytes] = certificate.id;
  for (Seed& seed : seeds_) {
    if (seed.key == certificate.link_key.bytes) seed.peer = certificate.id;
  }
  return peer;
}

void RouterCore::link_up(Link& link, const Certificate& certificate, const Hello& hello, Now now, Effects& out) {
  Peer& peer = peers_.at(certificate.id);
  link.peer = certificate.id;
  link.boot = hello.boot;
  link.up = true;
  link.last_heard = now.mono;
  link.confirmed = now.mono;
  link.next_keep_alive = now.mono + config_.timing.keep_alive;
  send_hello(link, now, out);
  const LinkId id = link.id;
  if (peer.link != 0 && !settle_double(link, peer, now, out)) return;
  const bool again = peer.boot == hello.boot && peer.met && !peer.expired;
  peer.boot = hello.boot;
  peer.address = hello.address;
  peer.version = hello.version;
  peer.clock_verified = hello.clock_verified;
  peer.profile = hello.profile;
  peer.link = id;
  peer.met = true;
  peer.expired = false;
  peer.lost.reset();
  peer.redial = {};
  out.log(LogLevel::info, "peer_joined",
          peer.id + " at " + peer.address + ", boot " + std::to_string(peer.boot) +
              (links_.at(id).dialled ? ", dialled by this node" : ", dialled by it"));
  if (!again) tell_services(PeerJoined{peer.id, peer.boot}, out);
}

bool RouterCore::settle_double(Link& link, Peer& peer, Now now, Effects& out) {
  const auto old = links_.find(peer.link);
  if (old == links_.end() || new_link_wins(old->second, link, own_is_smaller(peer.id))) {
    const LinkId gone = peer.link;
    peer.link = 0;
    drop_link(gone, "a better link to " + peer.id + " came up", true, now, out);
    return true;
  }
  drop_link(link.id, "a better link to " + peer.id + " is up", true, now, out);
  return false;
}

void RouterCore::drop_link(LinkId id, const std::string& why, bool say_goodbye, Now now, Effects& out) {
  const auto at = links_.find(id);
  if (at == links_.end()) return;
  Link& link = at->second;
  const bool carried = link.up && peers_.count(link.peer) != 0 && peers_.at(link.peer).link == id;
  if (say_goodbye && link.up) link_send(link, Goodbye{why.substr(0, 128)}, out);
  out.log(LogLevel::info, "link_closed", (link.peer.empty() ? "unproven" : link.peer) + ": " + why);
  out.add(CloseLink{id});
  const std::string name = link.peer;
  links_.erase(at);
  redial_failed(id, now);
  if (!carried) return;
  Peer& peer = peers_.at(name);
  peer.link = 0;
  peer.lost = now.mono;
  peer.last_heard = now.mono;
  // Both may dial again; the greater id gives the smaller a head start.
  redial_later(peer.redial, now, own_is_smaller(name) ? Duration{} : config_.timing.yield);
}

void RouterCore::on_link_ended(LinkId id, LinkEnd how, Now now, Effects& out) {
  const auto at = links_.find(id);
  if (at == links_.end()) return;
  if (how != LinkEnd::failed && how != LinkEnd::disconnected) out.count("dial." + std::string(name_of(how)));
  drop_link(id, std::string(name_of(how)), false, now, out);
}

void RouterCore::refuse_candidate(LinkId id, BytesView key, const Error& error, Now now, Effects& out) {
  out.count("refused." + std::string(errc_name(error.code)));
  out.log(LogLevel::warning, "candidate_refused", error.text());
  if (peers_by_key_.count(key) == 0) {
    candidates_.erase(Bytes(key));
    if (denied_.size() < 8 * kMaxCandidates) denied_[Bytes(key)] = now.mono + config_.timing.denied;
  }
  Message message;
  message.type = MessageType::information;
  message.subtype = Goodbye::kSubtype;
  message.source = config_.id;
  message.id = ++message_count_;
  message.data = encode(Goodbye{std::string(errc_name(error.code))});
  out.add(RefuseCandidate{id, std::move(message)});
}

}  // namespace trb::router
