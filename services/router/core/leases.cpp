// What time does: keep-alives, leases, dialling again, beacons, candidates that said nothing.
#include "common/base/hex.hpp"
#include "services/router/core/router_core.hpp"

namespace trb::router {

std::optional<MonotonicTime> RouterCore::next_deadline() const {
  std::optional<MonotonicTime> next =
      earlier(earlier(next_beacon_, next_store_), earlier(next_seal(), earlier(next_neighbours_, sensors_end())));
  for (const auto& [id, link] : links_) {
    const MonotonicTime lapse = std::min(link.last_heard, link.confirmed) + config_.timing.lease;
    next = earlier(next, link.up ? std::min(link.next_keep_alive, lapse) : link.opened + config_.timing.handshake);
    next = earlier(next, link.lane.dial_at);
  }
  for (const auto& [id, peer] : peers_) {
    next = earlier(earlier(next, peer.road.next_deadline()), profile_due(peer));
    if (peer.link != 0) continue;
    next = earlier(next, peer.redial.at);
    if (peer.lost && !peer.expired) next = earlier(next, *peer.lost + config_.timing.lease);
  }
  for (const Seed& seed : seeds_) next = earlier(next, seed.redial.at);
  for (const auto& [key, until] : candidates_) next = earlier(next, until);
  return earlier(earlier(next, next_own_check_), unstored_.next());
}

void RouterCore::tick(Now now, Effects& out) {
  check_own(now, out);
  note_time(now, out);
  tick_seals(now, out);
  tick_links(now, out);
  tick_peers(now, out);
  tick_seeds(now, out);
  tick_beacon(now, out);
  tick_candidates(now, out);
  tick_known(now, out);
  tick_unstored(now, out);
  tick_relay(now, out);
  tick_roads(now, out);
  tick_sensors(now, out);
  tick_lanes(now, out);
}

void RouterCore::tick_links(Now now, Effects& out) {
  struct Lapse {
    LinkId link;
    std::string_view code;
    std::string why;
  };
  std::vector<Lapse> lapsed;
  for (auto& [id, link] : links_) {
    if (link.up && checked_utc(now.utc).ns >= peers_.at(link.peer).certificate.not_after) {
      lapsed.push_back({id, "cert_expired", "its certificate has ended"});
    } else if (!link.up) {
      if (now.mono >= link.opened + config_.timing.handshake) lapsed.push_back({id, "no_hello", "no Hello in time"});
    } else if (now.mono >= link.last_heard + config_.timing.lease) {
      lapsed.push_back({id, "not_heard", std::string(kUnheard)});
    } else if (now.mono >= link.confirmed + config_.timing.lease) {
      // Cut both ways, the echo ends a little before the words do; cut one way, TCP soon stalls in the other too, but
      // beacons go on.
      const MonotonicTime heard = std::max(link.last_heard, peers_.at(link.peer).last_beacon);
      const bool still_heard = now.mono - heard < config_.timing.lease * 3 / 5;
      // What is said here tells the other side whether it is a one-way cut.
      lapsed.push_back({id, still_heard ? "one_way" : "not_heard",
                        still_heard ? "not heard by the other side for a lease" : std::string(kUnheard)});
    } else if (now.mono >= link.next_keep_alive) {
      link.next_keep_alive = now.mono + config_.timing.keep_alive;
      // A keep-alive says: what was before it is sealed.
      seal_now(id, out);
      link_send(link, KeepAlive{link.heard}, out);
      // It gets this number or, behind what is on its way out already, a higher one.
      link.unconfirmed.push_back(seals_.at(id).writer.next());
    }
  }
  for (const auto& [id, code, why] : lapsed) {
    if (code == "cert_expired") out.count("refused.cert_expired");
    note_trouble(id, code, why, now);
    drop_link(id, why, true, now, out);
  }
}

void RouterCore::tick_peers(Now now, Effects& out) {
  for (auto& [id, peer] : peers_) {
    if (peer.link != 0) continue;
    if (peer.lost && !peer.expired && now.mono >= *peer.lost + config_.timing.lease) expire(peer, "lease ended", out);
    if (peer.redial.at && now.mono >= *peer.redial.at) {
      if (news_.muted) {
        peer.redial.at = now.mono + config_.timing.redial_most;
        continue;
      }
      // After an outage both sides dial: two handshakes for one link, where the second could wait for the first's end.
      if (now.mono < peer.comes_until || dialling(peer.certificate.link_key.bytes)) {
        peer.redial.at = now.mono + config_.timing.redial_first;
        continue;
      }
      const std::string& address = address_to_dial(peer);
      if (address.empty()) {
        peer.redial.at.reset();  // until it tells one: by a beacon, a relay, or a link that it makes
        continue;
      }
      dial(peer.redial, address, peer.certificate.link_key.bytes, now, out);
    }
  }
}

void RouterCore::expire(Peer& peer, const std::string& reason, Effects& out) {
  peer.expired = true;
  out.count("peer_expired");
  out.log(LogLevel::warning, "peer_expired", peer.id + ": " + reason);
  tell_services(PeerExpired{peer.id, reason}, out);
}

void RouterCore::tick_seeds(Now now, Effects& out) {
  for (Seed& seed : seeds_) {
    if (!seed.redial.at || now.mono < *seed.redial.at) continue;
    const auto peer = peers_.find(seed.peer);
    const bool over = news_.muted || news_.revoked_keys.count(seed.key) != 0;
    if (seed.hint && peer != peers_.end() && peer->second.met) {
      seed.redial.at.reset();
    } else if (over || (peer != peers_.end() && peer->second.link != 0) || dialling(seed.key)) {
      // The link is there, or is being dialled by another way; look again later, in case that address is lost.
      seed.redial.at = now.mono + config_.timing.redial_most;
    } else {
      dial(seed.redial, seed.address, seed.key, now, out);
    }
  }
}

void RouterCore::tick_beacon(Now now, Effects& out) {
  if (news_.muted) return next_beacon_.reset();
  if (!next_beacon_ || now.mono < *next_beacon_) return;
  constexpr Duration kBurst = std::chrono::milliseconds(300);
  next_beacon_ = now.mono + (early_beacons_ > 0 ? kBurst : config_.timing.beacon);
  if (early_beacons_ > 0) --early_beacons_;
  last_beacon_ = now.mono;
  const Beacon beacon{config_.certificate, config_.address, config_.boot, now.utc.ns, ++beacon_count_};
  const SignedRecord record = sign(kSignedBeacon, config_.id, config_.authority.id(), encode(beacon), config_.identity);
  out.count("sent.beacon");
  out.add(SendBeacon{encode(record)});
}

void RouterCore::tick_candidates(Now now, Effects& out) {
  for (auto at = candidates_.begin(); at != candidates_.end();) {
    if (now.mono < at->second) {
      ++at;
      continue;
    }
    count("refused.no_hello");
    out.log(LogLevel::warning, "no_hello",
            "the unknown key " + to_hex(at->first) + " connected and said no Hello in time");
    if (denied_.size() < 8 * kMaxCandidates) denied_[at->first] = now.mono + config_.timing.denied;
    at = candidates_.erase(at);
  }
  const auto is_over = [&](const auto& row) { return now.mono >= row.second; };
  std::erase_if(noisy_, is_over);
  std::erase_if(denied_, is_over);
}

void RouterCore::refuse_beacon(std::string_view reason, const std::string& text, Now now, Effects& out) {
  troubles_.note("", "", "beacon." + std::string(reason), text, now.mono);
  out.count("beacon." + std::string(reason));
  out.log(LogLevel::warning, "beacon_refused", std::string(reason) + ": " + text);
}

/// A node that starts says so several times. What it would change needs no signature checked to be nothing: it is
/// linked, by that boot and at that address, and a beacon of its own was checked just now.
bool RouterCore::tells_nothing(const std::string& signer, const Beacon& beacon, Now now) const {
  constexpr Duration kFresh = std::chrono::seconds(2);
  const auto at = peers_.find(signer);
  if (at == peers_.end() || at->second.link == 0) return false;
  const Peer& peer = at->second;
  return beacon.boot == peer.boot && beacon.boot == peer.beacon_boot && beacon.count > peer.beacon_count &&
         beacon.address == peer.address && beacon.certificate == peer.certificate_record &&
         now.mono < peer.last_beacon + kFresh;
}

void RouterCore::on_beacon(BytesView plain, Now now, Effects& out) {
  const auto refuse = [&](const Error& error) { refuse_beacon(errc_name(error.code), error.what, now, out); };
  auto record = decode<SignedRecord>(plain);
  if (!record) return refuse(record.error());
  if (record->signer == config_.id) return;
  auto outer = decode<Beacon>(record->payload.bytes);
  if (!outer) return refuse(outer.error());
  if (tells_nothing(record->signer, *outer, now)) return;
  // Whoever has the fleet's key for beacons, a node put out of it for one, could keep this one at signatures alone.
  if (!beacon_budget_.take(now.mono)) {
    return refuse_beacon("too_many", "over " + std::to_string(kBeaconsChecked) + " in a second; links do without", now,
                         out);
  }
  auto certificate = open_member(outer->certificate, now, out);
  if (!certificate) return refuse(certificate.error());
  if (auto proven = open_record<Beacon>(*record, kSignedBeacon, *certificate); !proven) return refuse(proven.error());
  if (Status numbers = check_address("address", outer->address, certificate->id); !numbers)
    return refuse(numbers.error());
  if (peers_.size() >= kMaxPeers && peers_.count(certificate->id) == 0) {
    return refuse_beacon("too_many_peers", "the routing table has no row for '" + certificate->id + "'", now, out);
  }
  const auto known = peers_.find(certificate->id);
  if (known != peers_.end()) {
    const Peer& peer = known->second;
    const bool old = (peer.link != 0 && outer->boot < peer.boot) ||
                     std::pair(outer->boot, outer->count) <= std::pair(peer.beacon_boot, peer.beacon_count) ||
                     certificate->serial < peer.certificate.serial;
    if (old) return refuse_beacon("replayed", "of '" + peer.id + "', not newer than one that was heard", now, out);
    if (peer.link != 0 && peer.boot == outer->boot && peer.address == outer->address) {
      known->second.beacon_boot = outer->boot;
      known->second.beacon_count = outer->count;
      known->second.last_beacon = now.mono;
      return;
    }
  }
  Peer& peer = make_peer(*certificate, outer->certificate);
  peer.beacon_boot = outer->boot;
  peer.beacon_count = outer->count;
  peer.last_beacon = now.mono;
  const bool again = outer->boot > peer.boot;
  set_peer_address(peer, outer->address, now, out);
  if (peer.redial.link != 0) return;
  // Unlinked, or linked to a process that is gone or to where it was: the smaller id dials now, the greater answers
  // with a beacon of its own.
  const bool stale = peer.link != 0;
  if (stale) drop_link(peer.link, again ? "its node was started again" : "its address has changed", false, now, out);
  peer.redial.wait = {};
  peer.redial.at = now.mono + (own_is_smaller(peer.id) ? Duration{} : config_.timing.yield);
  constexpr Duration kAnswer = std::chrono::milliseconds(200);
  if (!own_is_smaller(peer.id) && next_beacon_ && now.mono - last_beacon_ > 2 * kAnswer) {
    next_beacon_ = std::min(*next_beacon_, now.mono + kAnswer);
  }
}

}  // namespace trb::router
