#include "services/router/test/test_fleet.hpp"

#include "common/base/address.hpp"

namespace trb::router {
namespace {

Bytes frame_of(LinkId link, std::uint64_t sequence, const Message& message) {
  Bytes frame = encode_frame(message);
  stamp_link(frame.data(), link, sequence, message.remaining_ms);
  return frame;
}

Error no_room() {
  return fail(Errc::io_error, "/n/state/news: cannot write: No space left on device", "make room: df -h /n");
}

std::string lane_of(const std::string& address) {
  return address.substr(0, address.rfind(':')) + ":45001";
}

}  // namespace

TestKeys& TestFleet::keys(const std::string& id) {
  const auto at = keys_.find(id);
  return at != keys_.end() ? at->second : keys_.emplace(id, authority.sign_node(id)).first->second;
}

std::string TestFleet::address(const std::string& id) {
  const auto number = std::to_string(addresses_.size() + 1);
  return addresses_.try_emplace(id, "10.0.0." + number + ":45000").first->second;
}

TestNode& TestFleet::start(const std::string& id, const Options& options) {
  auto node = std::make_unique<TestNode>();
  node->id = id;
  node->clock_off = options.clock_off;
  if (options.relay) authority.let_relay(keys(id));
  node->keys = keys(id);
  RouterConfig config;
  config.id = id;
  config.authority = authority.fleet;
  config.certificate = node->keys.record;
  config.own = node->keys.certificate;
  config.identity = node->keys.identity;
  config.link_key = node->keys.link;
  config.address = address(id);
  places_[config.address] = id;
  config.boot = options.boot;
  if (options.disk_full) config.boot_stored = no_room();
  node->disk = options.disk_full ? TestNode::Disk::full : TestNode::Disk::good;
  config.random = [this] { return next_random(); };
  config.beacon = options.beacon;
  config.seal_before_delivery = options.seal_before_delivery;
  config.relay = options.relay;
  config.role = options.role;
  if (options.lane) config.lane = lane_of(config.address);
  config.services = {"router", "mode-adapter", "scheduler", "resilience", "sensor-bus", "cloud-gateway", "fault-tally"};
  for (const std::string& seed : options.seeds) config.seeds.push_back({address(seed), keys(seed).link.public_key});
  for (const std::string& hint : options.known) config.known.push_back({address(hint), keys(hint).link.public_key});
  for (const auto& [seed, name] : options.seed_names) config.seeds.push_back({name, keys(seed).link.public_key});
  for (const auto& [hint, name] : options.known_names) config.known.push_back({name, keys(hint).link.public_key});
  node->core = std::make_unique<RouterCore>(std::move(config));
  TestNode& out = *node;
  nodes_[id] = std::move(node);
  Effects effects;
  out.core->start(now_of(out), effects);
  carry_out(out, effects);
  return out;
}

/// SplitMix64: no two are the same, and each run has the same ones.
std::uint64_t TestFleet::next_random() {
  std::uint64_t value = random_ += 0x9e3779b97f4a7c15ULL;
  value = (value ^ (value >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  value = (value ^ (value >> 27U)) * 0x94d049bb133111ebULL;
  return value ^ (value >> 31U);
}

void TestFleet::stop(const std::string& id) {
  nodes_.erase(id);
  std::erase_if(bound_, [&](const auto& row) { return row.first == id; });
  std::vector<LinkId> broken;
  for (const auto& [link, wire] : wires_) {
    if (wire.open && (wire.dialler == id || wire.acceptor == id)) broken.push_back(link);
  }
  for (const LinkId link : broken) break_wire(link);
}

void TestFleet::move(const std::string& id, const std::string& address) {
  std::erase_if(places_, [&](const auto& row) { return row.second == id; });
  places_[address] = id;
  for (auto& [link, wire] : wires_) {
    if (wire.dialler == id || wire.acceptor == id) wire.open = false;
  }
  Effects effects;
  at(id).core->set_address(address, "", now_of(at(id)), effects);
  carry_out(at(id), effects);
}

void TestFleet::break_wire(LinkId link) {
  Wire& wire = wires_.at(link);
  wire.open = false;
  const auto dialler = nodes_.find(wire.dialler);
  if (dialler == nodes_.end()) return;
  Effects effects;
  dialler->second->core->links().on_ended(link, LinkEnd::disconnected, now_of(*dialler->second), effects);
  carry_out(*dialler->second, effects);
}

void TestFleet::carry_out(TestNode& node, Effects& effects) {
  std::vector<Dial> dials;
  std::vector<DialLane> lanes;
  for (Effect& effect : effects.list) {
    std::visit(Overloaded{
                   [&](BusSend& send) { node.bus.push_back(send); },
                   [&](LinkSend& send) { this->send(node, send.link, send.message); },
                   [&](SealDue& due) { send_seal(node, due.link); },
                   [&](CheckSeal& seal) {
                     Effects checked;
                     node.core->forwarding().on_seal_checked(seal, verify_seal(seal.record, seal.signer), now, checked);
                     carry_out(node, checked);
                   },
                   [&](DeliverHeld& proven) {
                     auto& held = held_[{node.id, proven.link}];
                     for (; !held.empty() && held.front().first <= proven.last; held.pop_front())
                       node.delivered.push_back(held.front().second);
                   },
                   [&](ReturnHeld& of) {
                     std::vector<HeaderView> headers;
                     auto& held = held_[{node.id, of.link}];
                     for (const auto& [sequence, message] : held) headers.push_back(header_of(message, sequence));
                     Effects nacks;
                     node.core->forwarding().on_returned(of, headers, nacks);
                     carry_out(node, nacks);
                   },
                   [&](Dial& dial) { dials.push_back(dial); },
                   [&](DialLane& dial) { lanes.push_back(dial); },
                   [&](CloseLink& close) {
                     node.closed.push_back(close.link);
                     bound_.erase({node.id, close.link});
                     held_.erase({node.id, close.link});
                     node.core->seals().forget(close.link);
                     close_lanes(node, close.link);
                   },
                   [&](AcceptLink& accept) {
                     bound_.insert({node.id, accept.link});
                   },
                   [&](SendBeacon& beacon) {
                     node.beacons.push_back(beacon.plain);
                     beacons_.emplace_back(node.id, beacon.plain);
                   },
                   [&](StorePeers& store) { node.stored = store.text; },
                   [&](RefuseCandidate& refuse) {
                     node.refused.push_back(refuse);
                     if (!origin_.empty()) packets_.push_back({node.id, origin_, refuse.link, 1, refuse.message});
                   },
                   [&](StoreUpdate& store) {
                     node.stored_updates.push_back(store);
                     this->store(node, Kept::update);
                   },
                   [&](StoreCertificate& store) {
                     node.stored_certificates.push_back(store.record);
                     this->store(node, Kept::certificate);
                   },
                   [&](StoreBoot&) {
                     ++node.stored_boots;
                     this->store(node, Kept::boot);
                   },
                   [&](StoreUtc& store) { node.stored_utc.push_back(store.utc); },
                   [&](Log& line) { node.log.push_back(line.event + " " + line.text); },
               },
               effect);
  }
  for (const std::string& name : effects.counts) ++node.counts[name];
  for (const Dial& dial : dials) connect(node, dial);
  for (const DialLane& dial : lanes) connect_lane(node, dial);
}

void TestFleet::store(TestNode& node, Kept what) {
  if (node.disk == TestNode::Disk::silent) return;
  const bool full = node.disk == TestNode::Disk::full;
  Effects effects;
  node.core->updates().on_stored(what, full ? Status(no_room()) : Status(Done{}), now_of(node), effects);
  carry_out(node, effects);
}

bool TestFleet::is_open(LinkId link) const {
  const auto wire = wires_.find(link);
  return wire != wires_.end() && wire->second.open;
}

void TestFleet::send(TestNode& node, LinkId link, const Message& message) {
  if (!is_open(link) || (withhold && withhold(node.id, message))) return;
  Bytes frame = encode_frame(message);
  const Outgoing outgoing = node.core->seals().send(link, frame.data(), frame.size(), now);
  put_outgoing(node, link, outgoing, frame);
}

void TestFleet::put_outgoing(TestNode& node, LinkId link, const Outgoing& outgoing, BytesView frame) {
  if (!outgoing.known) return;
  if (!is_open(link)) return node.core->seals().not_sent(link, Unsent::frame);
  if (!outgoing.before.empty()) put(node, link, outgoing.before);
  put(node, link, frame);
  if (!outgoing.behind.empty()) put(node, link, outgoing.behind);
}

void TestFleet::send_seal(TestNode& node, LinkId link) {
  const auto seal = node.core->seals().make_seal(link, now);
  if (!seal) return;
  if (!is_open(link)) return node.core->seals().not_sent(link, Unsent::behind);
  put(node, link, *seal);
}

void TestFleet::put(TestNode& node, LinkId link, BytesView frame) {
  const Wire& wire = wires_.at(link);
  const std::string to = wire.dialler == node.id ? wire.acceptor : wire.dialler;
  const auto header = decode_frame(frame);
  packets_.push_back({node.id, to, link, header->sequence, to_message(*header)});
}

void TestFleet::say(const std::string& from, const std::string& to, const std::string& word, const Bytes& data) {
  Message message;
  message.type = MessageType::information;
  message.subtype = word;
  message.source = from;
  message.target = to;
  message.data = data;
  send(at(from), at(from).link_to(to), message);
}

void TestFleet::ask(const std::string& from, const std::string& to, const std::string& word, const Bytes& data) {
  TestNode& node = at(from);
  std::uint64_t slot = 0;
  for (const BusSend& send : node.bus) {
    if (send.to == 1 && send.message.subtype == ServiceWelcome::kSubtype)
      slot = decode<ServiceWelcome>(send.message.data)->slot;
  }
  Message message;
  message.type = MessageType::request;
  message.subtype = word;
  message.source = from;
  message.target = to;
  message.id = slot << 48U | 1U;
  message.data = data;
  forward(node, 1, message);
}

void TestFleet::connect(TestNode& node, const Dial& dial) {
  if (is_numeric_endpoint(dial.address)) return connect_numbers(node, dial);
  if (const auto host = hosts.find(dial.address); host != hosts.end()) {
    node.core->links().on_name_found(dial.link, host->second);
    return connect_numbers(node, {dial.link, host->second, dial.server_key});
  }
  Effects effects;
  node.core->links().on_name_unknown(dial.link, "the name server has not answered for " + dial.address + " yet",
                                     now_of(node), effects);
  carry_out(node, effects);
}

void TestFleet::connect_numbers(TestNode& node, const Dial& dial) {
  node.dials.push_back(dial);
  const auto place = places_.find(dial.address);
  const std::string there_is = place == places_.end() ? "" : place->second;
  const auto other = nodes_.find(there_is);
  Effects there;
  Effects here;
  const bool cut = cuts_.count({node.id, there_is}) + cuts_.count({there_is, node.id}) > 0;
  if (cut) return;  // no answer comes: the core's own timeout ends it
  if (other == nodes_.end() || other->second->keys.link.public_key != dial.server_key) {
    node.core->links().on_ended(dial.link, LinkEnd::failed, now_of(node), here);
  } else if (!other->second->core->admission().admit(node.keys.link.public_key, now, there)) {
    node.core->links().on_ended(dial.link, LinkEnd::refused_key, now_of(node), here);
  } else {
    wires_[dial.link] = {node.id, there_is, true};
    node.core->handshake().on_dial_connected(dial.link, now_of(node), here);
  }
  if (other != nodes_.end()) carry_out(*other->second, there);
  carry_out(node, here);
}

void TestFleet::connect_lane(TestNode& node, const DialLane& dial) {
  node.lane_dials.push_back(dial);
  const auto place = places_.find(dial.address.substr(0, dial.address.rfind(':')) + ":45000");
  const auto other = nodes_.find(place == places_.end() ? "" : place->second);
  const Bytes own_key = node.keys.link.public_key;
  Effects there;
  Effects here;
  const auto ended = [&](LinkEnd how) { node.core->lanes().on_ended(dial.link, how, now_of(node), here); };
  if (cuts_.count({node.id, place == places_.end() ? "" : place->second}) != 0) return;
  if (other == nodes_.end() || other->second->keys.link.public_key != dial.server_key) {
    ended(LinkEnd::failed);
  } else if (!other->second->core->lanes().admit(own_key, there)) {
    ended(LinkEnd::refused_key);
  } else {
    node.core->lanes().on_connected(dial.link, now_of(node));
    if (other->second->core->lanes().on_listen(own_key, topic_of(node.id), there)) {
      lanes_[{node.id, dial.link}] = other->first;
    } else {
      ended(LinkEnd::disconnected);
    }
  }
  if (other != nodes_.end()) carry_out(*other->second, there);
  carry_out(node, here);
}

void TestFleet::break_lane(const std::string& listener, const std::string& speaker) {
  const LinkId link = at(listener).link_to(speaker);
  lanes_.erase({listener, link});
  at(speaker).core->lanes().on_listener_gone(at(speaker).link_to(listener));
  Effects effects;
  at(listener).core->lanes().on_ended(link, LinkEnd::disconnected, now_of(at(listener)), effects);
  carry_out(at(listener), effects);
}

/// What the two shells do when either closes a link: the listener's socket closes, the speaker cuts its connection.
void TestFleet::close_lanes(const TestNode& node, LinkId link) {
  for (auto lane = lanes_.begin(); lane != lanes_.end();) {
    const auto [listener, by] = lane->first;
    const std::string speaker = lane->second;
    const bool mine = by == link && (listener == node.id || speaker == node.id);
    lane = mine ? lanes_.erase(lane) : std::next(lane);
    if (!mine) continue;
    if (listener == node.id && nodes_.count(speaker) != 0)
      at(speaker).core->lanes().on_listener_gone(at(speaker).link_to(listener));
    Effects effects;
    if (speaker == node.id && nodes_.count(listener) != 0)
      at(listener).core->lanes().on_ended(link, LinkEnd::disconnected, now_of(at(listener)), effects);
  }
}

Routing TestFleet::stream(const std::string& from, const Message& message) {
  TestNode& node = at(from);
  const Routing way = node.core->routing().lossy(message.target, encode_frame(message).size(), now_of(node));
  if (way.to == Routing::To::peer) send(node, way.link, message);
  if (way.to != Routing::To::lane) return way;
  for (const auto& [listener, speaker] : lanes_) {
    if (speaker != from || listener.first != message.target) continue;
    TestNode& there = at(listener.first);
    Effects effects;
    const Routing taken = there.core->routing().from_lane(listener.second, header_of(message), effects);
    if (taken.to == Routing::To::service) there.delivered.push_back(message);
    carry_out(there, effects);
  }
  return way;
}

Routing TestFleet::arrive(TestNode& node, LinkId link, std::uint64_t sequence, const Message& message) {
  Effects effects;
  const HeaderView header = header_of(message, sequence, link);
  const FrameOrders orders =
      node.core->forwarding().from_link(link, header, frame_of(link, sequence, message), now_of(node), effects);
  if (orders.way.to == Routing::To::service && orders.hold) {
    held_[{node.id, link}].emplace_back(sequence, message);
  } else if (orders.way.to == Routing::To::service) {
    node.delivered.push_back(message);
  }
  carry_out(node, effects);
  return orders.way;
}

Routing TestFleet::forward(TestNode& node, ConnectionId from, const Message& message) {
  Effects effects;
  Bytes frame = encode_frame(message);
  const FrameOrders orders =
      node.core->forwarding().from_bus(from, header_of(message), frame.data(), frame.size(), now_of(node), effects);
  if (orders.way.to == Routing::To::peer) put_outgoing(node, orders.way.link, orders.outgoing, frame);
  carry_out(node, effects);
  return orders.way;
}

void TestFleet::deliver(const Packet& packet) {
  const auto at = nodes_.find(packet.to);
  if (at == nodes_.end() || cuts_.count({packet.from, packet.to}) != 0) return;
  const auto wire = wires_.find(packet.link);
  if (wire == wires_.end() || !wire->second.open) return;
  TestNode& node = *at->second;
  const bool dialled_here = wire->second.dialler == packet.to;
  if (dialled_here ? node.core->table().link(packet.link) != nullptr : bound_.count({packet.to, packet.link}) != 0) {
    arrive(node, packet.link, packet.sequence, packet.message);
    return;
  }
  if (dialled_here) return;  // the socket is closed
  origin_ = packet.from;
  Effects effects;
  node.core->forwarding().from_stranger(keys(packet.from).link.public_key,
                                        header_of(packet.message, packet.sequence, packet.link),
                                        frame_of(packet.link, packet.sequence, packet.message), now_of(node), effects);
  carry_out(node, effects);
  origin_.clear();
}

void TestFleet::run(Duration time) {
  const MonotonicTime end = now.mono + time;
  while (now.mono < end) {
    now = {now.mono + kStep, now.utc + kStep};
    for (auto& [id, node] : nodes_) {
      Effects effects;
      if (const auto due = node->core->next_deadline(); due && *due <= now.mono)
        node->core->tick(now_of(*node), effects);
      carry_out(*node, effects);
    }
    auto packets = std::exchange(packets_, {});
    for (Packet& packet : packets) {
      if (!meddle || meddle(packet.from, packet.link, packet.sequence, packet.message)) deliver(packet);
    }
    auto beacons = std::exchange(beacons_, {});
    for (const auto& [from, plain] : beacons) {
      for (auto& [id, node] : nodes_) {
        if (id == from || cuts_.count({from, id}) != 0) continue;
        Effects effects;
        node->core->beacons().on_beacon(plain, now_of(*node), effects);
        carry_out(*node, effects);
      }
    }
  }
}

}  // namespace trb::router
