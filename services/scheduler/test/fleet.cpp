#include "services/scheduler/test/fleet.hpp"

#include <doctest/doctest.h>

#include "common/security/rights.hpp"

namespace trb::scheduler::test {

Fleet::Fleet(std::uint64_t seed) : network_(seed, weather) {}

Node& Fleet::add(const std::string& id, Role role) {
  Node& node = nodes_.try_emplace(id, events_, [this, id] { run_adapter(nodes_.at(id)); }).first->second;
  node.id = id;
  node.role = role;
  identities_.add(id, role);
  start(id);
  return node;
}

SignedRecord Fleet::sign_order(const std::string& by, const std::string& run) const {
  return sign(by, kSignedRunAbort, encode(AbortOrder{run, by, "enough", now().utc.ns}));
}

void Fleet::ask(const std::string& node, MessageType type, Body body) {
  asked_.insert(messages_ + 1);
  hear(node, node, type, std::move(body));
}

Outbox Fleet::tell(const std::string& node, const std::string& source, MessageType type, Body body,
                   std::uint64_t reply_to) {
  Outbox told;
  Node& to = nodes_.at(node);
  const Inbound message{type, source, node, ++messages_, reply_to, 0, kDefaultRemainingMs, std::move(body)};
  to.process->step([&](Now now, Outbox& out) {
    to.core->on(message, now, out);
    told = out;
    out.sends.clear();
  });
  return told;
}

void Fleet::hear(const std::string& node, const std::string& source, MessageType type, Body body) {
  happen(nodes_.at(node), Service::scheduler,
         {type, source, node, ++messages_, 0, 0, kDefaultRemainingMs, std::move(body)});
}

RunView Fleet::view(const std::string& id, const std::string& run) {
  Node& node = nodes_.at(id);
  run_adapter(node);
  const Inbound question{MessageType::request, id, id, ++messages_, 0, 0, 1000, RunQuery{run}};
  std::vector<RunView> views;
  node.process->step([&](Now now, Outbox& out) {
    node.core->on(question, now, out);
    views = sent<RunView>(out);
    std::erase_if(out.sends, [&](const Send& send) { return send.reply_to == question.id; });
  });
  return views.empty() ? RunView{} : views.front();
}

void Fleet::stop(const std::string& id) {
  Node& node = nodes_.at(id);
  node.up = false;
  node.guest.reset();
  node.process.reset();
  node.core.reset();
}

void Fleet::start(const std::string& id) {
  Node& node = nodes_.at(id);
  stop(id);
  node.core =
      std::make_unique<SchedulerCore>(SchedulerSettings{id, authority(), node.role == Role::robot}, *node.archive);
  const Status restored = node.core->restore(node.journal.records());
  REQUIRE_MESSAGE(restored.ok(), (restored ? "" : restored.error().text()));
  node.process = std::make_unique<world::CoreProcess>(process_settings(node), *node.core, events_, node.clock);
  node.up = true;
  node.process->welcome({id, node.role, 1});
}

world::ProcessSettings Fleet::process_settings(Node& node) {
  world::ProcessSettings out;
  out.inspect = [this](const Outbox& effects) {
    for (const std::string& name : effects.counts) ++counted[name];
  };
  out.store = [this, &node](const std::vector<Journal>& records) { store(node, records); };
  out.send = [this, &node](const Send& one) { send(node, one); };
  out.crash = &node.crash;
  out.on_crash = [this, &node] { crash(node.id); };
  return out;
}

void Fleet::store(Node& node, const std::vector<Journal>& records) {
  ++node.commits;
  for (const Journal& record : records) node.journal.commit(read_back(record), *node.archive);
}

void Fleet::crash(const std::string& node) {
  stop(node);
  events_.after(seconds(0.3), [this, node] { start(node); });
}

void Fleet::attach(const std::string& id, Core& core, world::ProcessSettings disk) {
  Node& node = nodes_.at(id);
  disk.send = [this, &node](const Send& one) { send_of_guest(node, one); };
  node.guest = std::make_unique<world::CoreProcess>(std::move(disk), core, events_, node.clock);
  node.guest->welcome({id, node.role, 1});
}

Body Fleet::carried_over(const Body& body) {
  if (++bodies_ % coded_every != 0) return body;
  auto coded = decode_body(subtype_of(body), encode_body(body));
  REQUIRE_MESSAGE(coded.ok(), (coded ? "" : coded.error().text()));
  return std::move(*coded);
}

JournalRecord Fleet::read_back(const Journal& journal) {
  auto record = to_journal_record(journal.record);
  REQUIRE_MESSAGE(record.ok(), (record ? "" : record.error().text()));
  if (++bodies_ % coded_every != 0) return std::move(*record);
  auto coded = decode_record(kind_of(*record), encode_record(*record));
  REQUIRE_MESSAGE(coded.ok(), (coded ? "" : coded.error().text()));
  return std::move(*coded);
}

Inbound Fleet::message_of(const Node& node, const Send& send) {
  return {send.type,     node.id,    send.target,       ++messages_,
          send.reply_to, send.flags, send.remaining_ms, carried_over(send.body)};
}

void Fleet::send(Node& node, const Send& send) {
  Inbound message = message_of(node, send);
  if (send.reply_to != 0 && asked_.contains(send.reply_to)) {
    answers.push_back(std::move(message.body));
  } else if (send.target == node.id && guests_asked_.contains(send.reply_to)) {
    post(node.id, Service::guest, seconds(0.001), std::move(message));
  } else if (send.target == node.id) {
    send_local(node, message);
  } else {
    send_away(node, message);
  }
}

void Fleet::send_local(Node& node, const Inbound& message) {
  if (network_.loses_locally()) return;
  if (const auto* request = get_if<SignRequest>(&message.body)) {
    REQUIRE_MESSAGE(may_sign(node.role, request->kind), (node.id + " " + request->kind));
    REQUIRE(may_have_signed("scheduler", false, request->kind));
    answer(node.id, message, seconds(0.002), sign(node.id, request->kind, request->payload.bytes));
  } else if (const auto* asked = get_if<RouteListRequest>(&message.body)) {
    answer(node.id, message, seconds(0.001), routes(node, asked->after));
  } else if (holds_alternative<SensorRead>(message.body)) {
    read_sensor(node, message);
  } else {
    post(node.id, Service::adapter, seconds(0.001), message);
  }
}

void Fleet::answer(const std::string& from, const Inbound& asked, Duration delay, Body body, Service to) {
  post(asked.source, to, delay,
       {MessageType::information, from, asked.source, ++messages_, asked.id, 0, 1000, std::move(body)});
}

void Fleet::read_sensor(Node& node, const Inbound& message) {
  if (!node.sensors.hangs) answer(node.id, message, seconds(0.01), node.sensors.answer(get<SensorRead>(message.body)));
}

RouteTable Fleet::routes(const Node& node, const std::string& after) const {
  RouteTable table{node.id, {}, false, after};
  for (auto at = nodes_.upper_bound(after); at != nodes_.end(); ++at) {
    const auto& [id, other] = *at;
    table.more = table.routes.size() == page;
    if (table.more) break;
    Route route;
    route.id = id;
    route.state = id == node.id ? "self" : node.cut || other.cut ? "CONNECTION_BROKEN" : "ONLINE";
    route.role = other.role;
    route.certificate = identities_.certificate(id);
    route.profile = other.profile;
    route.profile.fenced = other.adapter.is_fenced();
    route.profile.out_of_use = other.adapter.out_of_use;
    route.profile.plugged = other.sensors.infos();
    table.routes.push_back(std::move(route));
  }
  return table;
}

void Fleet::nack(Node& node, const Inbound& message, Errc code) {
  if (message.type == MessageType::information || message.reply_to != 0) return;
  answer(
      node.id, message, seconds(0.001),
      Nack{std::string(errc_name(code)), std::string(subtype_of(message.body)), message.target, "not delivered", ""});
}

void Fleet::send_away(Node& node, const Inbound& message) {
  const auto target = nodes_.find(message.target);
  REQUIRE(target != nodes_.end());
  ++carried[std::string(subtype_of(message.body))];
  if (node.cut || target->second.cut) return nack(node, message, Errc::peer_unreachable);
  if (holds_alternative<SensorRead>(message.body)) {
    if (!network_.loses()) read_sensor(target->second, message);
    return;
  }
  if (!target->second.up) return nack(node, message, Errc::no_service);
  for (const Duration delay : network_.arrivals()) post(message.target, Service::scheduler, delay, message);
}

void Fleet::send_of_guest(Node& node, const Send& send) {
  Inbound message = message_of(node, send);
  if (send.reply_to != 0 && asked_.contains(send.reply_to)) return answers.push_back(std::move(message.body));
  constexpr std::size_t kRemembered = 10'000;
  guests_asked_.insert(message.id);
  if (guests_asked_.size() > kRemembered) guests_asked_.erase(guests_asked_.begin());
  if (send.target != node.id) return send_of_guest_away(node, nodes_.at(send.target), message);
  if (const auto* request = get_if<SignRequest>(&message.body)) {
    REQUIRE(may_sign(node.role, request->kind));
    REQUIRE(may_have_signed("resilience", false, request->kind));
    Body record = sign(node.id, request->kind, request->payload.bytes);
    return answer(node.id, message, seconds(0.002), std::move(record), Service::guest);
  }
  if (const auto* asked = get_if<RouteListRequest>(&message.body)) {
    return answer(node.id, message, seconds(0.001), routes(node, asked->after), Service::guest);
  }
  post(node.id, Service::scheduler, seconds(0.005), std::move(message));
}

void Fleet::send_of_guest_away(Node& node, Node& to, const Inbound& message) {
  const auto reply = [&](const std::string& from, Duration delay, Body body) {
    answer(from, message, delay, std::move(body), Service::guest);
  };
  if (node.cut || to.cut || !to.up) {
    return reply(node.id, seconds(0.001),
                 Nack{"peer_unreachable", std::string(subtype_of(message.body)), to.id, "is away", ""});
  }
  if (const auto* value = get_if<Opaque>(&message.body)) {
    const auto told = to.values.find(value->subtype);
    if (told != to.values.end()) reply(to.id, seconds(0.02), Opaque{value->subtype, told->second});
    return;
  }
  if (const auto* repaired = get_if<TakeIntoUse>(&message.body)) {
    to.adapter.take_into_use(*repaired);
    run_adapter(to);
    return reply(to.id, seconds(0.02), Ack{"in_use", ""});
  }
  post(to.id, Service::scheduler, seconds(0.005), message);
}

void Fleet::post(const std::string& node, Service to, Duration delay, Inbound message) {
  events_.after(delay, [this, &is = nodes_.at(node), to, message = std::move(message)] { happen(is, to, message); });
}

void Fleet::happen(Node& node, Service to, const Inbound& message) {
  if (to == Service::adapter) {
    node.adapter.hear(message, events_.now());
    return run_adapter(node);
  }
  const bool guests = to == Service::guest || guests_asked_.contains(message.reply_to);
  const auto& process = guests ? node.guest : node.process;
  if (process) process->take(message);
}

void Fleet::run_adapter(Node& node) {
  node.adapter.tick(events_.now());
  for (FakeAdapter::Said& said : node.adapter.take()) {
    if (network_.loses_locally()) continue;
    post(node.id, Service::scheduler, seconds(0.001),
         {MessageType::information, node.id, node.id, ++messages_, said.reply_to, 0, 1000, std::move(said.body)});
  }
  touch(node);
}

void Fleet::touch(Node& node) {
  node.adapter_timer.set(node.adapter.next());
}

/// A test may have changed any mode-adapter.
void Fleet::touch_all() {
  for (auto& [id, node] : nodes_) touch(node);
}

void Fleet::after(Duration delay, std::function<void()> what) {
  events_.after(delay, [this, what = std::move(what)] {
    what();
    touch_all();
  });
}

bool Fleet::until(const std::function<bool()>& done, Duration limit) {
  const MonotonicTime end = events_.now() + limit;
  while (!done()) {
    touch_all();
    if (!events_.step(end)) return done();
  }
  return true;
}

void Fleet::pass(Duration time) {
  const MonotonicTime end = events_.now() + time;
  touch_all();
  while (events_.step(end)) {
  }
}

void add_demonstration(Fleet& fleet) {
  fleet.add("cloud", Role::cloud);
  for (const char* robot : {"conveyor", "drone", "pioneer", "ridgeback", "ur3"}) fleet.add(robot, Role::robot);
}

}  // namespace trb::scheduler::test
