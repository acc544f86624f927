#include "services/router/core/answers.hpp"

#include <algorithm>

namespace trb::router {
namespace {

constexpr std::size_t kRoutePage = 256U << 10U;               ///< a row takes 66 kB of it at most
constexpr std::size_t kRouteWords = 512;                      ///< a row's own words and numbers, at most
constexpr Duration kFleetComes = std::chrono::seconds(3);     ///< members that nobody expects are linked by then
constexpr Duration kFleetGathers = std::chrono::seconds(10);  ///< who is expected, and not linked by then, is away

/// As much of both as fits into a note; no UTF-8 letter is cut in two.
std::string join_notes(const std::string& first, const std::string& second) {
  std::string out = first + (first.empty() || second.empty() ? "" : "; ") + second;
  auto end = std::min<std::size_t>(out.size(), kDefaultMaxSize);
  while (end > 0 && (static_cast<unsigned char>(out[end]) & 0xc0U) == 0x80) --end;
  return out.substr(0, end);
}

}  // namespace

Result<Body> Answers::to_request(const Message& message, Now now) const {
  if (message.type == MessageType::request) {
    if (message.subtype == RouteListRequest::kSubtype) {
      auto request = decode<RouteListRequest>(message.data);
      if (!request) return request.error();
      return Body{route_table(now, request->after)};
    }
    if (message.subtype == ServiceListRequest::kSubtype) return Body{service_table(now)};
    if (message.subtype == RouterCountersRequest::kSubtype) return Body{counters_.table(node_.id(), "router")};
    if (message.subtype == ServiceCountersRequest::kSubtype) return service_counters(message);
    if (message.subtype == LinkErrorTableRequest::kSubtype) return Body{errors_.table(node_.id(), now.mono)};
    if (message.subtype == EchoRequest::kSubtype) {
      auto request = decode<EchoRequest>(message.data);
      if (!request) return request.error();
      return Body{Echo{std::move(request->pad)}};
    }
  }
  return fail(Errc::bad_value, message.subtype + " is not for a router in this way");
}

/// Those of a service that is connected never come here (MessageRouting::counting_service): it answers itself.
Result<Body> Answers::service_counters(const Message& message) const {
  auto request = decode<ServiceCountersRequest>(message.data);
  if (!request) return request.error();
  if (request->service == "router") return Body{counters_.table(node_.id(), "router")};
  return fail(Errc::no_service, "'" + node_.id() + "' has no service '" + request->service + "' that is up",
              "see trb service list");
}

/// A request of a hundred bytes returns a table: a peer that sends them without end would keep this node busy for
/// itself. An echo is as long as its request.
Result<Body> Answers::to_peer(Peer& peer, const Message& message, Now now) const {
  const bool table = message.type == MessageType::request && message.subtype != EchoRequest::kSubtype;
  if (table && !peer.answers.has_room(now.mono)) {
    return fail(Errc::queue_full,
                message.subtype + ": in this second '" + peer.id + "' was told " + std::to_string(kAnsweredOfOne) +
                    " bytes already",
                "ask less often");
  }
  return to_request(message, now);
}

void Answers::charge(Peer& peer, const Message& request, const Message& answer) {
  if (request.subtype != EchoRequest::kSubtype) peer.answers.spend(answer.data.size());
}

Route Answers::route_of(const Peer& peer, Now now) const {
  const Link* link = table_.link(peer.link);
  const Link* relay = link == nullptr ? relays_.relay_of(peer) : nullptr;
  const std::string state = link != nullptr || relay != nullptr ? "ONLINE"
                            : peer.expired || !peer.met         ? "OFFLINE"
                                                                : "CONNECTION_BROKEN";
  const MonotonicTime heard = link != nullptr    ? link->last_heard
                              : relay != nullptr ? relays_.route(peer).connection.last_sign()
                                                 : peer.last_heard;
  return {peer.id,
          peer.certificate.role,
          peer.address,
          state,
          to_seconds(now.mono - heard),
          peer.boot,
          peer.link,
          link == nullptr ? ""
          : link->dialled ? node_.id()
                          : peer.id,
          peer.version,
          peer.clock_verified ? "verified" : "unverified",
          peer.certificate_record,
          peer.profile,
          relay == nullptr ? "" : relay->peer};
}

RouteTable Answers::route_table(Now now, const std::string& after) const {
  RouteTable table{node_.id(), {}, false, after, gathers(now)};
  std::size_t size = 0;
  const auto add = [&](Route&& route) {
    size += kRouteWords + encode(route.certificate).size() + encode(route.profile).size();
    // The first row always has room, and this node's own row is never the last: the cursor names a peer.
    table.more = size > kRoutePage && table.routes.size() > 1;
    if (!table.more) table.routes.push_back(std::move(route));
    return !table.more;
  };
  if (after.empty()) {
    const bool verified = node_.knows_the_time(now);
    add({node_.id(), node_.config().role, node_.config().address, "self", 0, node_.config().boot, 0, "",
         node_.config().version, verified ? "verified" : "unverified", node_.config().certificate, profile_.profile(),
         ""});
  }
  for (auto at = table_.peers().upper_bound(after); at != table_.peers().end(); ++at) {
    if (!add(route_of(at->second, now))) break;
  }
  return table;
}

/// Members come one by one: those that send beacons, those that were linked in the run before or that node.json names,
/// and the robot whose mode-adapter is to report.
bool Answers::gathers(Now now) const {
  const Duration up = now.mono - started_;
  if (up < kFleetComes || up >= kFleetGathers) return up < kFleetComes;
  const std::vector<std::string>& services = node_.config().services;
  const bool robot = !profile_.has_robot() && std::ranges::find(services, "mode-adapter") != services.end();
  return robot || table_.awaited() > 0;
}

ServiceTable Answers::service_table(Now now) const {
  const RouterConfig& own = node_.config();
  ServiceTable table{own.id, {}};
  table.services.push_back(
      {"router",
       "up",
       own.pid,
       own.instance,
       own.version,
       to_seconds(now.mono - started_),
       0,
       {},
       join_notes(join_notes(membership_.note(now), updates_.note()), own.machine_note ? own.machine_note() : "")});
  for (const std::string& name : own.services) {
    if (name != "router") table.services.push_back(entry_of(name, now));
  }
  return table;
}

ServiceEntry Answers::entry_of(const std::string& name, Now now) const {
  const auto holder = bus_.services().holder(name);
  if (!holder) return {name, "down", 0, 0, "", 0, 0, {}, {}};
  const Connection& connection = *bus_.services().find(*holder);
  const Duration quiet = now.mono - connection.last_heard;
  return {name,
          quiet > node_.config().timing.service_silent ? "silent" : "up",
          connection.hello.pid,
          connection.hello.instance,
          connection.hello.version,
          to_seconds(now.mono - connection.since),
          to_seconds(quiet),
          connection.hello.subtypes,
          connection.hello.waits.empty() ? connection.note : std::string(kWaitsNote) + connection.hello.waits};
}

}  // namespace trb::router
