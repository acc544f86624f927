#include "services/router/test/test_fleet.hpp"

#include "common/base/address.hpp"
#include "common/base/bytes.hpp"

namespace trb::router {
namespace {

/// Its bytes take no time.
world::LinkKind quick_link() {
  world::LinkKind out;
  out.delay = kOnTheWay;
  out.bytes_a_second = 1'000'000'000'000'000'000;
  return out;
}

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

TestFleet::TestFleet() : network_(events_, meter_, dice_, quick_link()) {
  init_crypto();
  network_.meddle = [this](const std::string& from, LinkId link, Bytes& frame) {
    return meddle_with(from, link, frame);
  };
}

TestKeys& TestFleet::keys(const std::string& id) {
  const auto at = keys_.find(id);
  return at != keys_.end() ? at->second : keys_.emplace(id, authority.sign_node(id)).first->second;
}

std::string TestFleet::address(const std::string& id) {
  const auto number = std::to_string(addresses_.size() + 1);
  return addresses_.try_emplace(id, "10.0.0." + number + ":45000").first->second;
}

RouterConfig TestFleet::config_of(const std::string& id, const Options& options) {
  RouterConfig config;
  config.id = id;
  config.role = options.role;
  config.authority = authority.fleet;
  config.certificate = keys(id).record;
  config.own = keys(id).certificate;
  config.identity = keys(id).identity;
  config.link_key = keys(id).link;
  config.address = address(id);
  config.boot = options.boot;
  if (options.disk_full) config.boot_stored = no_room();
  config.updates_lost = options.updates_lost;
  config.random = [this] { return next_random(); };
  config.beacon = options.beacon;
  config.seal_before_delivery = options.seal_before_delivery;
  config.relay = options.relay;
  if (options.lane) config.lane = lane_of(config.address);
  config.services = {"router", "mode-adapter", "scheduler", "resilience", "sensor-bus", "cloud-gateway", "fault-tally"};
  for (const std::string& seed : options.seeds) config.seeds.push_back({address(seed), keys(seed).link.public_key});
  for (const std::string& hint : options.known) config.known.push_back({address(hint), keys(hint).link.public_key});
  for (const auto& [seed, name] : options.seed_names) config.seeds.push_back({name, keys(seed).link.public_key});
  for (const auto& [hint, name] : options.known_names) config.known.push_back({name, keys(hint).link.public_key});
  return config;
}

TestNode& TestFleet::start(const std::string& id, const Options& options) {
  if (options.relay) authority.let_relay(keys(id));
  places_[address(id)] = id;
  auto made = std::make_unique<TestNode>(config_of(id, options), events_, network_, meter_);
  TestNode& node = *made;
  node.id = id;
  node.keys = keys(id);
  node.clock_off = options.clock_off;
  node.disk = options.disk_full ? TestNode::Disk::full : TestNode::Disk::good;
  node.router.watch(watch_of(node));
  // What the tests' services say and hear goes by the core alone.
  for (int service = 0; service < 16; ++service) node.router.bus().connect("", [](const Bytes&) {});
  nodes_[id] = std::move(made);
  keep_time();
  node.router.start();
  return node;
}

world::RouterWatch TestFleet::watch_of(TestNode& node) {
  return {.on_order = [this, &node](const Effect& order) { take(node, order); },
          .on_delivery = [&node](ConnectionId,
                                 BytesView frame) { node.delivered.push_back(to_message(*decode_frame(frame))); },
          .withholds = [this,
                        &node](const HeaderView& header) { return withhold && withhold(node.id, to_message(header)); },
          .writes = [&node](Kept) -> std::optional<Status> {
            if (node.disk == TestNode::Disk::silent) return std::nullopt;
            return node.disk == TestNode::Disk::full ? Status(no_room()) : Status(Done{});
          }};
}

void TestFleet::take(TestNode& node, const Effect& order) {
  std::visit(Overloaded{
                 [&](const BusSend& send) { node.bus.push_back(send); },
                 [&](const Dial& dial) {
                   const auto is = hosts.find(dial.address);
                   if (is_numeric_endpoint(dial.address)) node.dials.push_back(dial);
                   if (is != hosts.end()) node.dials.push_back({dial.link, is->second, dial.server_key});
                 },
                 [&](const DialLane& dial) {
                   node.lane_dials.push_back(dial);
                   events_.after({}, [this, id = node.id, dial] {
                     if (nodes_.contains(id)) connect_lane(at(id), dial);
                   });
                 },
                 [&](const CloseLink& close) {
                   node.closed.push_back(close.link);
                   close_lanes(node, close.link);
                 },
                 [&](const AcceptLink& accept) {
                   // A test that speaks for a dialler has no connection.
                   if (!network_.has(accept.link)) network_.attach(accept.link, "", {}, node.id);
                 },
                 [&](const SendBeacon& beacon) { node.beacons.push_back(beacon.plain); },
                 [&](const StorePeers& store) { node.stored = store.text; },
                 [&](const RefuseCandidate& refuse) { node.refused.push_back(refuse); },
                 [&](const StoreUpdate& store) { node.stored_updates.push_back(store); },
                 [&](const StoreCertificate& store) { node.stored_certificates.push_back(store.record); },
                 [&](const StoreBoot&) { ++node.stored_boots; },
                 [&](const StoreUtc& store) { node.stored_utc.push_back(store.utc); },
                 [&](const Log& line) { node.log.push_back(line.event + " " + line.text); },
                 [](const auto&) {},
             },
             order);
}

bool TestFleet::meddle_with(const std::string& from, LinkId link, Bytes& frame) const {
  if (!meddle) return true;
  const auto header = decode_frame(frame);
  std::uint64_t sequence = header->sequence;
  Message message = to_message(*header);
  const bool arrives = meddle(from, link, sequence, message);
  frame = frame_of(link, sequence, message);
  return arrives;
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
}

void TestFleet::cut(const std::string& from, const std::string& to) {
  cuts_.insert({from, to});
  network_.cut(from, to);
}

void TestFleet::heal() {
  for (const auto& [from, to] : std::exchange(cuts_, {})) network_.heal(from, to);
}

void TestFleet::move(const std::string& id, const std::string& address) {
  std::erase_if(places_, [&](const auto& row) { return row.second == id; });
  places_[address] = id;
  network_.move(id, address);
  Effects effects;
  at(id).core->set_address(address, "", now_of(at(id)), effects);
  carry_out(at(id), effects);
}

void TestFleet::carry_out(TestNode& node, Effects& effects) {
  keep_time();
  node.router.follow(effects);
}

void TestFleet::say(const std::string& from, const std::string& to, const std::string& word, const Bytes& data) {
  Message message;
  message.type = MessageType::information;
  message.subtype = word;
  message.source = from;
  message.target = to;
  message.data = data;
  keep_time();
  at(from).router.send(at(from).link_to(to), word, encode_frame(message));
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

void TestFleet::connect_lane(TestNode& node, const DialLane& dial) {
  const auto place = places_.find(dial.address.substr(0, dial.address.rfind(':')) + ":45000");
  const auto other = nodes_.find(place == places_.end() ? "" : place->second);
  const Bytes own_key = node.keys.link.public_key;
  Effects there;
  Effects here;
  const auto ended = [&](LinkEndReason how) { node.core->lanes().on_ended(dial.link, how, now_of(node), here); };
  if (cuts_.count({node.id, place == places_.end() ? "" : place->second}) != 0) return;
  if (other == nodes_.end() || other->second->keys.link.public_key != dial.server_key) {
    ended(LinkEndReason::failed);
  } else if (!other->second->core->lanes().admit(own_key, there)) {
    ended(LinkEndReason::refused_key);
  } else {
    node.core->lanes().on_connected(dial.link, now_of(node));
    if (other->second->core->lanes().on_listen(own_key, topic_of(node.id), there)) {
      lanes_[{node.id, dial.link}] = other->first;
    } else {
      ended(LinkEndReason::disconnected);
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
  at(listener).core->lanes().on_ended(link, LinkEndReason::disconnected, now_of(at(listener)), effects);
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
      at(listener).core->lanes().on_ended(link, LinkEndReason::disconnected, now_of(at(listener)), effects);
  }
}

Routing TestFleet::stream(const std::string& from, const Message& message) {
  TestNode& node = at(from);
  const Routing way = node.core->routing().lossy(message.target, encode_frame(message).size(), now_of(node));
  if (way.to == Routing::To::peer) node.router.send(way.link, message.subtype, encode_frame(message));
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
  keep_time();
  const Bytes frame = frame_of(link, sequence, message);
  const auto header = decode_frame(frame);
  return header ? node.router.from_link(link, *header, frame) : Routing{};
}

Routing TestFleet::forward(TestNode& node, ConnectionId from, const Message& message) {
  keep_time();
  const Bytes frame = encode_frame(message);
  const auto header = decode_frame(frame);
  return header ? node.router.from_bus(from, *header, frame) : Routing{};
}

/// Time passes here by events; a test may also say what time it is.
void TestFleet::keep_time() {
  if (const Duration passed = events_.now() - now.mono; passed.count() > 0) now = {now.mono + passed, now.utc + passed};
  events_.skip_to(now.mono);
  for (const auto& [id, node] : nodes_) node->clock.set_utc(now_of(*node).utc);
}

void TestFleet::run(Duration time) {
  const MonotonicTime end = now.mono + time;
  Effects none;
  for (const auto& [id, node] : nodes_) carry_out(*node, none);  // a test may have called their cores
  while (events_.step(end)) keep_time();
  keep_time();
}

}  // namespace trb::router
