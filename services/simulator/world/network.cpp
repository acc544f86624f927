#include "services/simulator/world/network.hpp"

#include <algorithm>

namespace trb::world {
namespace {

constexpr Duration kResend = std::chrono::milliseconds(200);  ///< TCP's least time-out
constexpr int kRoundTrips = 4;                                ///< TCP, ZMTP, and CURVE's two
Host* const kNobody = nullptr;
constexpr std::uint64_t kWindow = 14'600;  ///< ten packets: what TCP sends before it hears that anything came

std::uint64_t bytes_of(const auto& parcel) {
  return parcel.end ? 0 : on_wire(parcel.frame.size());
}

}  // namespace

void Network::join(const std::string& id, const std::string& address, Host& host) {
  hosts_[id] = &host;
  addresses_[address] = id;
}

void Network::move(const std::string& id, const std::string& address) {
  std::erase_if(addresses_, [&](const auto& one) { return one.second == id; });
  addresses_[address] = id;
  for (auto& [link, is] : connections_) is.lost = is.lost || is.there.to == id || is.back.to == id;
}

void Network::attach(LinkId connection, const std::string& dialler, Bytes key, const std::string& acceptor) {
  Connection& row = connections_[connection];
  row = {way_to(acceptor), way_to(dialler), std::move(key), false};
  by_id_.set(connection, row);
}

template <class Is>
std::vector<LinkId> Network::connections_where(Is&& is) const {
  std::vector<LinkId> out;
  for (const auto& [link, connection] : connections_) {
    if (is(connection)) out.push_back(link);
  }
  return out;
}

void Network::leave(const std::string& id) {
  if (over_) return;
  hosts_[id] = nullptr;
  const auto ended = connections_where([&](const Connection& is) { return is.there.to == id || is.back.to == id; });
  for (const LinkId link : ended) {
    Connection& is = connections_.at(link);
    is.there.held.clear();  // its buffers are gone, and nobody is there for what others still send
    is.back.held.clear();
    (is.there.to == id ? is.there : is.back).host = &kNobody;
  }
  for (const LinkId link : ended) close(link, id);
}

Host* Network::host(const std::string& id) {
  const auto at = hosts_.find(id);
  return at == hosts_.end() ? nullptr : at->second;
}

void Network::heal(const std::string& from, const std::string& to) {
  if (cuts_.erase({from, to}) == 0) return;
  const auto between = [&](const Connection& is) {
    return (is.there.to == to && is.back.to == from) || (is.there.to == from && is.back.to == to);
  };
  for (const LinkId link : connections_where(between)) {
    for (const bool there : {true, false}) {
      connections_.at(link).way(there).unproven = 0;
      resume(link, there);
    }
  }
}

/// TCP sends all of it again, and hands it over in its order and before what was sent since.
void Network::resume(LinkId connection, bool there) {
  Way& way = connections_.at(connection).way(there);
  if (way.held.empty() || way.resumes) return;
  way.resumes = true;
  std::uint64_t bytes = 0;
  for (const Parcel& parcel : way.held) bytes += bytes_of(parcel);
  events_.at(arrival(way, bytes), [this, connection, there] { hand_over_held(connection, there); });
}

/// A part of it waits again if the way was cut again.
void Network::hand_over_held(LinkId connection, bool there) {
  Connection* is = by_id_.find(connection);
  if (is != nullptr) is->way(there).resumes = false;
  for (; is != nullptr; is = by_id_.find(connection)) {  // a host may end it
    Way& way = is->way(there);
    if (way.held.empty() || is_stopped(way, is->sender(there), way.held.front())) return;
    Parcel parcel = std::move(way.held.front());
    way.held.pop_front();
    hand_over(connection, *is, there, std::move(parcel));
  }
}

void Network::count(const std::string& from, const std::string& to, std::string_view subtype, std::uint64_t bytes,
                    BytesView frame) {
  meter_.on({events_.seconds_passed(), from, to, subtype, bytes, true}, frame);
}

Duration Network::delay() {
  if (kind_.measured.empty()) return dice_.normal(kind_.delay, kind_.deviation);
  return kind_.measured[dice_.below(kind_.measured.size())];
}

void Network::dial(const std::string& from, const router::Dial& dial) {
  Duration takes{0};
  for (int i = 0; i < 2 * kRoundTrips; ++i) takes += delay();
  events_.after(takes, [this, from, dial] { connect(from, dial); });
}

void Network::connect(const std::string& from, const router::Dial& dial) {
  Host* here = host(from);
  if (here == nullptr) return;
  const auto place = addresses_.find(dial.address);
  const std::string to = place == addresses_.end() ? "" : place->second;
  if (is_cut(from, to) || is_cut(to, from)) return;  // no answer comes: the router's own time-out ends it
  Host* there = host(to);
  if (there == nullptr || there->link_key() != dial.server_key)
    return here->on_dial_ended(dial.link, LinkEndReason::failed);
  if (!there->admit(here->link_key())) return here->on_dial_ended(dial.link, LinkEndReason::refused_key);
  meter_.on_connection(events_.seconds_passed(), kConnectBytes);
  attach(dial.link, from, here->link_key(), to);
  here->on_dial_connected(dial.link);
}

bool Network::send(LinkId connection, const std::string& from, std::string_view subtype, Bytes frame) {
  Connection* is = by_id_.find(connection);
  if (is == nullptr) return false;
  const bool there = is->back.to == from;
  count(from, is->way(there).to, subtype, on_wire(frame.size()), frame);
  post(connection, *is, there, {std::move(frame), false});
  return true;
}

/// It leaves when the connection is free.
MonotonicTime Network::arrival(Way& way, std::uint64_t bytes) {
  const auto takes = static_cast<std::int64_t>(bytes * 1'000'000'000U / kind_.bytes_a_second);
  way.free = std::max(events_.now(), way.free) + Duration{takes};
  Duration late = delay();
  for (Duration wait = kResend; dice_.chance(kind_.loss) && wait < std::chrono::seconds(10); wait *= 2) late += wait;
  way.last = std::max(way.last, way.free + late);
  slowest_ = std::max(slowest_, way.last - events_.now());
  return way.last;
}

void Network::post(LinkId connection, Connection& is, bool there, Parcel parcel) {
  const MonotonicTime at = arrival(is.way(there), bytes_of(parcel));
  events_.at(at, [this, connection, there, parcel = std::move(parcel)]() mutable {
    arrive(connection, there, std::move(parcel));
  });
}

bool Network::is_stopped(Way& way, const std::string& from, const Parcel& parcel) {
  if (is_cut(from, way.to)) return true;
  if (!is_cut(way.to, from)) return false;
  way.unproven += on_wire(parcel.frame.size());
  return way.unproven > kWindow;
}

void Network::arrive(LinkId connection, bool there, Parcel parcel) {
  Connection* is = by_id_.find(connection);
  if (is == nullptr || is->lost) return;
  Way& way = is->way(there);
  const bool waits = !way.held.empty() || is_stopped(way, is->sender(there), parcel);
  if (waits) return way.held.push_back(std::move(parcel));
  hand_over(connection, *is, there, std::move(parcel));
}

void Network::hand_over(LinkId connection, const Connection& is, bool there, Parcel parcel) {
  Host* here = *is.way(there).host;
  if (parcel.end) {
    by_id_.erase(connection);
    connections_.erase(connection);
  }
  if (here == nullptr) return;
  if (parcel.end) return here->on_connection_end(connection);
  if (meddle && !meddle(is.sender(there), connection, parcel.frame)) return;
  here->on_frame(connection, is.key, std::move(parcel.frame));
}

void Network::close(LinkId connection, const std::string& by) {
  if (Connection* is = by_id_.find(connection)) post(connection, *is, is->back.to == by, {{}, true});
}

void Network::broadcast(const std::string& from, const Bytes& plain) {
  count(from, "*", "beacon", plain.size() + kBeaconBytes, plain);
  const auto shared = std::make_shared<const Bytes>(plain);
  for (const auto& [id, is] : hosts_) {
    if (is == nullptr || id == from || is_cut(from, id) || dice_.chance(kind_.loss)) continue;
    events_.after(delay(), [to = &is, shared] {
      if (Host* there = *to) there->on_beacon(*shared);
    });
  }
}

}  // namespace trb::world
