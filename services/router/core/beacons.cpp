#include "services/router/core/beacons.hpp"

#include <algorithm>

#include "common/base/saturate.hpp"

namespace trb::router {

void Beacons::begin(Now now) {
  if (node_.config().beacon && !node_.config().address.empty()) next_ = now.mono;
}

void Beacons::burst(Now now) {
  if (!node_.config().beacon) return;
  early_ = 3;
  next_ = now.mono;
}

void Beacons::tick(Now now, Effects& out) {
  if (!next_ || now.mono < *next_) return;
  constexpr Duration kBurst = std::chrono::milliseconds(300);
  const RouterConfig& own = node_.config();
  next_ = now.mono + (early_ > 0 ? kBurst : own.timing.beacon);
  if (early_ > 0) --early_;
  last_ = now.mono;
  const Beacon beacon{own.certificate, own.address, own.boot, now.utc.ns, ++count_};
  out.count("sent.beacon");
  out.add(SendBeacon{encode(sign(kSignedBeacon, own.id, own.authority.id(), encode(beacon), own.identity))});
}

void Beacons::refuse(std::string_view reason, const std::string& text, Now now, Effects& out) {
  errors_.note("", "", "beacon." + std::string(reason), text, now);
  out.count("beacon." + std::string(reason));
  out.log(LogLevel::warning, "beacon_refused", std::string(reason) + ": " + text);
}

/// A starting node sends several beacons. No signature need be checked to see that one changes nothing: the peer is
/// linked, with that boot and address, and a beacon of it was checked just now.
bool Beacons::is_repeated(const std::string& signer, const Beacon& beacon, Now now) const {
  constexpr Duration kFresh = std::chrono::seconds(2);
  const Peer* known = table_.find(signer);
  if (known == nullptr || known->link == 0) return false;
  const Peer& peer = *known;
  return beacon.boot == peer.boot && beacon.boot == peer.beacon_boot && beacon.count > peer.beacon_count &&
         beacon.address == peer.address && beacon.certificate == peer.certificate_record &&
         now.mono < peer.last_beacon + kFresh;
}

void Beacons::on_beacon(BytesView plain, Now now, Effects& out) {
  const auto refuse_for = [&](const Error& error) { refuse(errc_name(error.code), error.what, now, out); };
  auto record = decode<SignedRecord>(plain);
  if (!record) return refuse_for(record.error());
  if (record->signer == node_.id()) return;
  auto beacon = decode<Beacon>(record->payload.bytes);
  if (!beacon) return refuse_for(beacon.error());
  if (is_repeated(record->signer, *beacon, now)) return;
  // Any holder of the fleet's beacon key, for example a revoked node, could keep this node busy checking signatures.
  if (!budget_.take(now.mono))
    return refuse("too_many", "over " + std::to_string(kBeaconsChecked) + " in a second; links do without", now, out);
  auto certificate = check(*record, *beacon, now, out);
  if (!certificate) return refuse_for(certificate.error());
  if (!table_.has_room_for(certificate->id))
    return refuse("too_many_peers", "the routing table has no row for '" + certificate->id + "'", now, out);
  const Peer* known = table_.find(certificate->id);
  if (known != nullptr && is_replayed(*known, *certificate, *beacon))
    return refuse("replayed", "of '" + known->id + "', not newer than one that was received", now, out);
  const bool linked =
      known != nullptr && known->link != 0 && known->boot == beacon->boot && known->address == beacon->address;
  Peer& peer = linked ? *table_.find(certificate->id) : table_.learn(*certificate, beacon->certificate);
  peer.beacon_boot = beacon->boot;
  peer.beacon_count = beacon->count;
  peer.last_beacon = now.mono;
  linked ? note_clock(peer, beacon->sent, now) : follow(peer, *beacon, now, out);
}

/// A clock that was set since the Hello: what was told of it then is over, or begins.
void Beacons::note_clock(const Peer& peer, std::int64_t utc, Now now) {
  errors_.note_clock(peer.id, utc, now);
  Link* link = table_.link(peer.link);
  if (link != nullptr && link->utc_at_zero) link->utc_at_zero = saturating_sub(utc, now.mono.ns);
}

Result<Certificate> Beacons::check(const SignedRecord& record, const Beacon& beacon, Now now, Effects& out) {
  auto certificate = trust_.open_member(beacon.certificate, now, out, record.signer);
  if (!certificate) return certificate;
  if (Status proven = check_record(record, kSignedBeacon, *certificate); !proven) return proven.error();
  if (Status numbers = check_address("address", beacon.address, certificate->id); !numbers) return numbers.error();
  return certificate;
}

bool Beacons::is_replayed(const Peer& peer, const Certificate& certificate, const Beacon& beacon) const {
  return (peer.link != 0 && beacon.boot < peer.boot) ||
         std::pair(beacon.boot, beacon.count) <= std::pair(peer.beacon_boot, peer.beacon_count) ||
         certificate.serial < peer.certificate.serial;
}

/// The peer is unlinked, or the link leads to an ended process or an old address: the smaller id dials now, the greater
/// answers with a beacon.
void Beacons::follow(Peer& peer, const Beacon& beacon, Now now, Effects& out) {
  const bool again = beacon.boot > peer.boot;
  links_.set_address(peer, beacon.address, now, out);
  if (peer.redial.link != 0) return;
  if (peer.link != 0)
    links_.drop(peer.link, again ? "its node was started again" : "its address has changed", false, now, out);
  links_.redial_soon(peer, now);
  constexpr Duration kAnswer = std::chrono::milliseconds(200);
  if (!node_.is_smaller_than(peer.id) && next_ && now.mono - last_ > 2 * kAnswer)
    next_ = std::min(*next_, now.mono + kAnswer);
}

}  // namespace trb::router
