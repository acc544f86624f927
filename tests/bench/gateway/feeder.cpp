#include "tests/bench/gateway/feeder.hpp"

#include <algorithm>
#include <cstdio>

#include "common/config/interfaces.hpp"
#include "common/fleet/charge.hpp"
#include "common/security/bus_keys.hpp"
#include "common/service/version.hpp"
#include "common/transport/signals.hpp"

namespace trb::bench {
namespace {

constexpr std::size_t kRoutesInPage = 512;
constexpr std::uint64_t kBoot = 1;
constexpr std::uint16_t kFirstSlot = 16;
constexpr Duration kStep = std::chrono::milliseconds(2);  ///< what has become due meanwhile is sent together

Bytes charge_of(std::uint64_t number) {
  return std::to_string(100 - number / 100 % 80);
}

}  // namespace

Feeder::Feeder(NodeConfig config, NodeKeys keys, int robots, double changes)
    : config_(std::move(config)),
      keys_(std::move(keys)),
      crowd_(robots, changes, read_clocks().mono),
      told_(static_cast<std::size_t>(robots)) {
  for (int i = 0; i < robots; ++i) numbers_[Crowd::name(i)] = i;
}

Result<CurveKeys> Feeder::read_keys() {
  auto own = load_bus_key(config_.dir, kBusRouter);
  if (!own) return own.error();
  for (const std::string& name : bus_names(config_)) {
    if (name == kBusRouter) continue;
    auto key = load_bus_public(config_.dir, name);
    if (!key) return key.error();
    names_[*key] = name;
  }
  return CurveKeys{std::move(own->public_key), std::move(own->secret_key)};
}

Status Feeder::open() {
  const auto keys = read_keys();
  if (!keys) return keys.error();
  zap_.emplace(context_, loop_, [this](BytesView, BytesView key) { return names_.contains(key); });
  auto bus = Socket::bus_server(context_, "", &*keys);
  if (!bus) return bus.error();
  auto tap = Socket::tap_server(context_, "", &*keys);
  if (!tap) return tap.error();
  const Endpoint at = split_endpoint(config_.bus);
  const auto endpoint = [&](int further) {
    return "tcp://" + join_host_port(at.host, static_cast<std::uint16_t>(at.port + further));
  };
  if (Status bound = bus->bind(endpoint(0)); !bound) return bound;
  if (Status bound = tap->bind(endpoint(1)); !bound) return bound;
  bus_ = std::move(*bus);
  tap_ = std::move(*tap);
  loop_.add_socket(
      bus_->handle(), [this] { drain_bus(); }, bus_->unseen());
  loop_.add_socket(
      tap_->handle(), [this] { drain_tap(); }, tap_->unseen());
  loop_.add_timer([this] { return std::optional(crowd_.next_due() + kStep); }, [this](Now now) { feed(now.mono); });
  return Done{};
}

void Feeder::run() {
  const Signals signals(loop_, [this](int) { loop_.stop(); });
  loop_.run();
  std::printf(R"({"sent": %llu, "no_room": %llu, "latest_ms": %.1f})"
              "\n",
              static_cast<unsigned long long>(sent_), static_cast<unsigned long long>(full_),
              1000 * to_seconds(latest_));
}

// ---- the bus

void Feeder::drain_bus() {
  Frame routing_id;
  Frame frame;
  for (int i = 0; i < kTurnMessages && bus_->receive(routing_id) && bus_->receive(frame); ++i) {
    const Bytes from(view_of(routing_id));
    const auto view = decode_frame(view_of(frame));
    if (view) on_message(from, to_message(*view));
    show('=', view_of(frame));
  }
}

void Feeder::drain_tap() {
  Frame frame;
  while (tap_->receive(frame)) {
    const BytesView subscription = view_of(frame);
    if (!subscription.empty()) listeners_ += subscription[0] == 1 ? 1 : -1;
  }
}

void Feeder::on_message(const Bytes& from, const Message& message) {
  if (message.subtype == ServiceHello::kSubtype) return on_hello(from, message);
  if (message.subtype == ServiceAlive::kSubtype)
    return answer(from, message, config_.id, ServiceAliveSeen{keys_.certificate.serial});
  if (message.type != MessageType::request) return;
  if (numbers_.contains(message.target)) return on_robot_request(from, message);
  on_request(from, message);
}

void Feeder::on_hello(const Bytes& from, const Message& message) {
  auto hello = decode<ServiceHello>(message.data);
  if (!hello) return;
  const auto slot = static_cast<std::uint16_t>(kFirstSlot + connections_.size());
  Connection& connection = connections_.try_emplace(from, Connection{{}, slot}).first->second;
  connection.hello = std::move(*hello);
  answer(from, message, config_.id, ServiceWelcome{config_.id, "cloud", connection.slot, 1, kBoot});
}

/// What the gateway asks of its own node: the router's table; of the scheduler and the resilience, which have nothing;
/// the signature of its audit log's head.
void Feeder::on_request(const Bytes& from, const Message& message) {
  if (message.subtype == RouteListRequest::kSubtype) {
    const auto request = decode<RouteListRequest>(message.data);
    return answer(from, message, config_.id, routes_after(request ? request->after : ""));
  }
  if (message.subtype == RunWatch::kSubtype) return answer(from, message, config_.id, RunTable{});
  if (message.subtype == AlertListRequest::kSubtype) return answer(from, message, config_.id, AlertTable{});
  if (message.subtype == SignRequest::kSubtype) {
    const auto request = decode<SignRequest>(message.data);
    if (!request) return;
    return answer(from, message, config_.id,
                  sign(request->kind, config_.id, keys_.authority.id(), request->payload.bytes, keys_.identity));
  }
  answer(from, message, config_.id,
         Nack{"unknown_target", message.subtype, message.target, "nobody takes it here", "start the node's services"});
}

void Feeder::on_robot_request(const Bytes& from, const Message& message) {
  const int robot = numbers_.at(message.target);
  const std::uint64_t number = told_[static_cast<std::size_t>(robot)];
  if (message.subtype == kPositionRequest) {
    return answer(from, message, message.target, Opaque{message.subtype, Crowd::position(robot, number)});
  }
  if (message.subtype == kChargeRequests[1]) {
    return answer(from, message, message.target, Opaque{message.subtype, charge_of(number)});
  }
  answer(from, message, message.target,
         Nack{"unknown_target", message.subtype, message.target, "the robot does not know it", "ask for its position"});
}

/// Pages, as a router gives its table: its own row first, then its peers in the order of their names.
RouteTable Feeder::routes_after(const std::string& after) const {
  RouteTable out{config_.id, {}, false, after};
  Route route;
  route.boot = kBoot;
  route.version = kVersion;
  route.clock = "verified";
  route.certificate = keys_.certificate_record;
  if (after.empty()) {
    route.id = config_.id;
    route.role = keys_.certificate.role;
    route.state = "self";
    out.routes.push_back(route);
  }
  route.role = Role::robot;
  route.state = "ONLINE";
  route.dialled_by = config_.id;
  for (auto at = numbers_.upper_bound(after); at != numbers_.end(); ++at) {
    out.more = out.routes.size() == kRoutesInPage;
    if (out.more) break;
    route.id = at->first;
    route.address = "10.0.0.1:45000";
    route.link = static_cast<std::uint64_t>(at->second) + 1;
    route.profile = Crowd::profile(at->second);
    out.routes.push_back(route);
  }
  return out;
}

// ---- the robots

void Feeder::feed(MonotonicTime now) {
  for (Crowd::Change change; crowd_.take(now, change);) {
    latest_ = std::max(latest_, now - change.due);
    tell(change);
  }
}

/// To whoever hears it, as a robot's state comes from its node: one frame, which the tap sees coming in.
void Feeder::tell(const Crowd::Change& change) {
  told_[static_cast<std::size_t>(change.robot)] = change.number;
  Message message;
  message.type = MessageType::information;
  message.subtype = RobotState::kSubtype;
  message.source = Crowd::name(change.robot);
  message.target = kEveryNode;
  message.id = ++last_id_;
  message.data = encode(Crowd::state(change));
  const Bytes frame = encode_frame(message);
  show('<', frame);
  for (const auto& [to, connection] : connections_) {
    const auto& hears = connection.hello.hears;
    if (std::ranges::find(hears, RobotState::kSubtype) == hears.end()) continue;
    const bool sent = bus_->send_to(to, to_frame(frame)) == SendResult::sent;
    ++(sent ? sent_ : full_);
  }
}

// ---- messages

void Feeder::answer(const Bytes& from, const Message& question, const std::string& source, const Body& body) {
  Message message;
  message.type = MessageType::information;
  message.subtype = subtype_of(body);
  message.source = source;
  message.target = config_.id;
  message.id = ++last_id_;
  message.reply_to = question.id;
  message.data = encode_body(body);
  send(from, message);
}

void Feeder::send(const Bytes& to, const Message& message) {
  const Bytes frame = encode_frame(message);
  show(message.source == config_.id ? '=' : '<', frame);
  bus_->send_to(to, to_frame(frame));
}

/// Two frames, as the router's tap has them.
void Feeder::show(char direction, BytesView frame) {
  if (listeners_ <= 0) return;
  tap_->send(to_frame(std::string(1, direction)), true);
  tap_->send(to_frame(frame));
}

}  // namespace trb::bench
