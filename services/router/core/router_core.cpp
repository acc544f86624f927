#include "services/router/core/router_core.hpp"

namespace trb::router {

RouterCore::RouterCore(RouterConfig config) : node_(std::move(config)), table_(node_.config()) {}

LinkParts RouterCore::parts() {
  return {node_,  table_, trust_,     admission_, messages_, bus_,       seals_,      links_,   errors_,      profile_,
          lanes_, known_, handshake_, updates_,   relays_,   reachable_, tell_again_, answers_, invitations_, routing_};
}

void RouterCore::start(Now now, Effects& out) {
  const RouterConfig& own = node_.config();
  answers_.start(now);
  out.log(LogLevel::info, "started", own.id + " at " + own.address + ", boot " + std::to_string(own.boot));
  links_.start(now);
  beacons_.begin(now);
  node_.start_clock(now);
  if (!node_.knows_the_time(now)) {
    out.log(LogLevel::warning, "clock_unverified",
            "the clock says " + to_iso8601(now.utc) + ", but it is " + to_iso8601(node_.checked_utc(now.utc)) +
                " at least: set it; if it was ahead before, remove state/utc");
  }
  // What was in force before this start is in force now, before the first link; each part is checked anew.
  trust_.restore_dropped(own.dropped);
  if (!own.updates_lost) updates_.on_file(own.updates, now, out);
  membership_.check_own(now, out);
  if (!own.boot_stored) updates_.on_stored(Kept::boot, own.boot_stored, now, out);
}

void RouterCore::set_address(const std::string& address, const std::string& why, Now now, Effects& out) {
  if (!node_.move_to(address, why)) return;
  out.count("address_changed");
  beacons_.stop();
  // Nothing arrives or leaves by the old address any more, and no event would report that.
  links_.drop_all("this node's address has changed", now, out);
  if (address.empty()) return;
  // The peers do not know the new address yet, so both ids dial at once; a beacon notifies the others.
  links_.redial_all(now);
  beacons_.burst(now);
}

void RouterCore::on_connection_gone(ConnectionId connection, Now now, Effects& out) {
  if (const auto service = bus_.on_gone(connection, out)) profile_.on_service_gone(*service, now);
}

void RouterCore::on_link_lost(Peer& peer, const Link& gone, Now now, Effects& out) {
  reachable_.on_change(peer.id, now);
  relays_.on_link_lost(peer, gone, now, out);
}

bool RouterCore::is_relayed(const Peer& peer) const {
  return relays_.relay_of(peer) != nullptr;
}

ReportersHeard RouterCore::reporters_heard() const {
  const auto heard = [](bool matters, const Connection* service) {  // otherwise no deadline depends on it
    return matters && service != nullptr ? std::optional(service->last_heard) : std::nullopt;
  };
  const Services& services = bus_.services();
  return {heard(profile_.has_plugged(), services.sensor_bus()), heard(profile_.has_robot(), services.mode_adapter())};
}

std::optional<MonotonicTime> RouterCore::next_deadline() const {
  std::optional<MonotonicTime> next = profile_.next_deadline(reporters_heard());
  for (const auto& due :
       {membership_.next_deadline(), seals_.next_deadline(), links_.next_deadline(), beacons_.next_deadline(),
        admission_.next_deadline(), known_.next_deadline(), updates_.next_deadline(), reachable_.next_deadline(),
        relays_.next_deadline(), lanes_.next_deadline(), invitations_.next_deadline(), tell_again_.next_deadline()}) {
    next = earlier(next, due);
  }
  return next;
}

void RouterCore::tick(Now now, Effects& out) {
  membership_.check_own(now, out);
  membership_.note_time(now, out);
  seals_.tick(now, out);
  links_.tick(!membership_.is_muted(), now, out);
  if (membership_.is_muted()) beacons_.stop();
  beacons_.tick(now, out);
  admission_.tick(now, out);
  known_.tick(now, out);
  updates_.tick(now, out);
  reachable_.tick(now, out);
  tell_again_.tick(now, out);
  relays_.tick(now, out);
  profile_.tick(reporters_heard(), now, out);
  lanes_.tick(now, out);
  invitations_.tick(now, out);
}

}  // namespace trb::router
