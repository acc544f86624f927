#include "services/simulator/world/router_process.hpp"

#include "common/base/address.hpp"
#include "common/security/seal.hpp"

namespace trb::world {

using router::FrameOrders;
using To = router::Routing::To;

RouterProcess::RouterProcess(router::RouterConfig config, UtcTime& utc_bound, Events& events, const Clock& clock,
                             Network& network, Meter& meter)
    : utc_bound_(utc_bound),
      events_(events),
      clock_(clock),
      network_(network),
      meter_(meter),
      core_(std::move(config)),
      bus_(events, *this),
      timer_(events, [this] { step([&](Now now, Effects& out) { core_.tick(now, out); }); }) {}

RouterProcess::~RouterProcess() {
  network_.leave(id());
}

template <class Step>
void RouterProcess::step(Step&& call) {
  Effects effects;
  call(clock_.now(), effects);
  carry_out(effects);
  timer_.set(core_.next_deadline());
}

void RouterProcess::follow(Effects& effects) {
  carry_out(effects);
  timer_.set(core_.next_deadline());
}

void RouterProcess::start() {
  network_.join(id(), core_.config().address, *this);
  step([&](Now now, Effects& out) { core_.start(now, out); });
}

std::size_t RouterProcess::linked() const {
  std::size_t out = 0;
  for (const auto& [peer, row] : core_.table().peers()) out += row.link != 0 ? 1U : 0U;
  return out;
}

// ---- the network

bool RouterProcess::admit(BytesView key) {
  bool good = false;
  step([&](Now now, Effects& out) { good = core_.admission().admit(key, now, out); });
  return good;
}

void RouterProcess::on_dial_connected(LinkId link) {
  step([&](Now now, Effects& out) { core_.handshake().on_dial_connected(link, now, out); });
}

void RouterProcess::on_dial_ended(LinkId link, LinkEndReason how) {
  step([&](Now now, Effects& out) { core_.links().on_ended(link, how, now, out); });
}

void RouterProcess::on_connection_end(LinkId connection) {
  // That an accepted link's connection is gone shows only at the next send.
  const router::Link* link = std::as_const(core_).table().link(connection);
  if (link == nullptr || link->dialled) on_dial_ended(connection, LinkEndReason::disconnected);
}

void RouterProcess::on_frame(LinkId connection, BytesView dialler_key, Bytes frame) {
  const auto header = decode_frame(frame);
  if (!header) return;
  const bool dialled_here = dialler_key == link_key();
  const router::Link* link = std::as_const(core_).table().link(connection);
  if (link != nullptr && link->dialled == dialled_here) return void(from_link(connection, *header, std::move(frame)));
  if (dialled_here) return;  // closed meanwhile
  origin_ = connection;
  step([&](Now now, Effects& out) { core_.forwarding().from_stranger(dialler_key, *header, frame, now, out); });
  origin_ = 0;
}

void RouterProcess::on_beacon(BytesView plain) {
  step([&](Now now, Effects& out) { core_.beacons().on_beacon(plain, now, out); });
}

router::Routing RouterProcess::from_link(LinkId link, const HeaderView& header, Bytes frame) {
  Routing way;
  step([&](Now now, Effects& out) {
    const FrameOrders orders = core_.forwarding().from_link(link, header, frame, now, out);
    for (const ConnectionId to : orders.copies) deliver(link, header.sequence, orders.hold, to, frame);
    if (orders.way.to == To::service) deliver(link, header.sequence, orders.hold, orders.way.connection, frame);
    way = orders.way;
  });
  return way;
}

void RouterProcess::deliver(LinkId link, std::uint64_t sequence, bool hold, ConnectionId to, Bytes frame) {
  if (hold) return held_[link].push_back({sequence, to, std::move(frame)});
  if (watch_.on_delivery) watch_.on_delivery(to, frame);
  bus_.to_service(to, std::move(frame));
}

// ---- the bus

void RouterProcess::on_bus_frame(ConnectionId from, const std::string& name, Bytes frame) {
  const auto header = decode_frame(frame);
  if (!header) return;
  if (header->subtype == ServiceHello::kSubtype) return on_hello(from, name, *header);
  if (core_.bus().knows(from)) from_bus(from, *header, std::move(frame));
}

router::Routing RouterProcess::from_bus(ConnectionId from, const HeaderView& header, Bytes frame) {
  FrameOrders orders;
  step([&](Now now, Effects& out) {
    orders = core_.forwarding().from_bus(from, header, frame.data(), frame.size(), now, out);
    if (orders.way.to == To::service || orders.way.to == To::router) count_local(header, frame);
    for (const ConnectionId to : orders.copies) bus_.to_service(to, frame);
    if (orders.way.to == To::service && !bus_.to_service(orders.way.connection, frame))
      core_.forwarding().on_unsent(from, header, Errc::no_service, out);
    if (orders.way.to == To::peer && !send(orders.way.link, orders.outgoing, header.subtype, frame))
      core_.forwarding().on_unsent(from, header, Errc::peer_unreachable, out);
  });
  for (const Routing& way : orders.each) send(way.link, header.subtype, frame);
  return orders.way;
}

void RouterProcess::on_hello(ConnectionId from, const std::string& name, const HeaderView& header) {
  const auto hello = decode<ServiceHello>(header.data);
  if (hello) step([&](Now now, Effects& out) { core_.bus().on_hello(from, *hello, name, now, out); });
}

void RouterProcess::count_local(const HeaderView& header, BytesView frame) {
  meter_.on({events_.seconds_passed(), id(), id(), header.subtype, frame.size(), false}, frame);
}

// ---- sending

bool RouterProcess::send(LinkId link, std::string_view subtype, Bytes frame) {
  if (watch_.withholds && watch_.withholds(*decode_frame(frame))) return true;
  const router::Outgoing outgoing = core_.seals().send(link, frame.data(), frame.size(), clock_.now());
  return send(link, outgoing, subtype, std::move(frame));
}

bool RouterProcess::send(LinkId link, const router::Outgoing& outgoing, std::string_view subtype, Bytes frame) {
  if (!outgoing.known) return false;
  if (!outgoing.before.empty() && !network_.send(link, id(), Seal::kSubtype, outgoing.before)) {
    core_.seals().not_sent(link, router::Unsent::before);
    lost_.push_back(link);
    return false;
  }
  if (!network_.send(link, id(), subtype, std::move(frame))) {
    core_.seals().not_sent(link, router::Unsent::frame);
    lost_.push_back(link);
    return false;
  }
  if (!outgoing.behind.empty() && !network_.send(link, id(), Seal::kSubtype, outgoing.behind))
    core_.seals().not_sent(link, router::Unsent::behind);
  return true;
}

// ---- the core's effects

void RouterProcess::carry_out(Effects& effects) {
  for (router::Effect& effect : effects.list) {
    if (watch_.on_order) watch_.on_order(effect);
    std::visit([this](auto& one) { carry_out(one); }, effect);
  }
  for (const std::string& name : effects.counts) core_.counters().count(name);
  for (const LinkId link : std::exchange(lost_, {})) on_dial_ended(link, LinkEndReason::disconnected);
}

void RouterProcess::carry_out(router::BusSend& send) {
  Bytes frame = encode_frame(send.message);
  count_local(to_view(send.message), frame);
  bus_.to_service(send.to, std::move(frame));
}

void RouterProcess::carry_out(router::Dial& dial) {
  if (is_numeric_endpoint(dial.address)) return network_.dial(id(), dial);
  if (const auto is = network_.names.find(dial.address); is != network_.names.end()) {
    core_.links().on_name_found(dial.link, is->second);
    return network_.dial(id(), {dial.link, is->second, dial.server_key});
  }
  const std::string why = "the name server has not answered for " + dial.address + " yet";
  step([&](Now now, Effects& out) { core_.links().on_name_unknown(dial.link, why, now, out); });
}

void RouterProcess::carry_out(router::LinkSend& own) {
  if (send(own.link, own.message.subtype, encode_frame(own.message))) return;
  Effects effects;
  core_.forwarding().on_own_unsent(own.message, Errc::peer_unreachable, clock_.now(), effects);
  carry_out(effects);
}

void RouterProcess::carry_out(router::CloseLink& close) {
  held_.erase(close.link);
  core_.seals().forget(close.link);
  network_.close(close.link, id());
}

void RouterProcess::carry_out(router::RefuseCandidate& refuse) {
  if (origin_ == 0) return;
  Bytes frame = encode_frame(refuse.message);
  stamp_link(frame.data(), refuse.link, 1, refuse.message.remaining_ms);
  stamp_version(frame.data(), refuse.version);
  network_.send(origin_, id(), refuse.message.subtype, std::move(frame));
}

void RouterProcess::stored(router::Kept what) {
  const std::optional<Status> how = watch_.writes ? watch_.writes(what) : Done{};
  if (!how) return;
  Effects effects;
  core_.updates().on_stored(what, *how, clock_.now(), effects);
  carry_out(effects);
}

void RouterProcess::carry_out(router::SealDue& due) {
  auto seal = core_.seals().make_seal(due.link, clock_.now());
  if (seal && !network_.send(due.link, id(), Seal::kSubtype, std::move(*seal)))
    core_.seals().not_sent(due.link, router::Unsent::behind);
}

/// In the shell a thread does it, beside the loop.
void RouterProcess::carry_out(router::CheckSeal& seal) {
  constexpr Duration kCheck = std::chrono::microseconds(150);
  events_.after(kCheck, life_, [this, seal = std::move(seal)] {
    const bool good = verify_seal(seal.record, *seal.signer);
    step([&](Now now, Effects& out) { core_.forwarding().on_seal_checked(seal, good, now, out); });
  });
}

void RouterProcess::carry_out(router::DeliverHeld& proven) {
  auto& held = held_[proven.link];
  for (; !held.empty() && held.front().sequence <= proven.last; held.pop_front()) {
    deliver(proven.link, held.front().sequence, false, held.front().to, std::move(held.front().frame));
  }
}

void RouterProcess::carry_out(router::ReturnHeld& of) {
  std::vector<HeaderView> headers;
  for (const Held& one : held_[of.link]) headers.push_back(*decode_frame(one.frame));
  Effects effects;
  core_.forwarding().on_returned(of, headers, effects);
  carry_out(effects);
}

}  // namespace trb::world
