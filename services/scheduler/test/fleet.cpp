#include "services/scheduler/test/fleet.hpp"

#include <doctest/doctest.h>

#include "common/security/rights.hpp"

namespace trb::scheduler::test {

Fleet::Fleet(std::uint64_t seed) : network_(seed, weather) {}

Node& Fleet::add(const std::string& id, Role role) {
  Node& node = nodes_[id];
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
  Inbound message{type, node, node, time_.next_number(), 0, 0, kDefaultRemainingMs, std::move(body)};
  asked_.insert(message.id);
  happen({node, false, false, false, std::move(message)});
}

Outbox Fleet::tell(const std::string& node, const std::string& source, MessageType type, Body body,
                   std::uint64_t reply_to) {
  Outbox out;
  Node& to = nodes_.at(node);
  to.core->on({type, source, node, time_.next_number(), reply_to, 0, kDefaultRemainingMs, std::move(body)}, now_at(to),
              out);
  for (const Journal& record : out.journal) to.journal.commit(read_back(record), *to.archive);
  touch(to);
  return out;
}

void Fleet::hear(const std::string& node, const std::string& source, MessageType type, Body body) {
  happen({node,
          false,
          false,
          false,
          {type, source, node, time_.next_number(), 0, 0, kDefaultRemainingMs, std::move(body)}});
}

RunView Fleet::view(const std::string& node, const std::string& run) {
  run_adapter(nodes_.at(node));
  Outbox out;
  nodes_.at(node).core->on({MessageType::request, node, node, time_.next_number(), 0, 0, 1000, RunQuery{run}},
                           now_at(nodes_.at(node)), out);
  const auto views = sent<RunView>(out);
  if (views.empty()) return {};
  std::erase_if(out.sends, [](const Send& send) { return holds_alternative<RunView>(send.body); });
  carry_out(nodes_.at(node), out);
  return views.front();
}

void Fleet::stop(const std::string& node) {
  nodes_.at(node).core.reset();
  nodes_.at(node).up = false;
  touch(nodes_.at(node));
}

void Fleet::start(const std::string& id) {
  Node& node = nodes_.at(id);
  node.core =
      std::make_unique<SchedulerCore>(SchedulerSettings{id, authority(), node.role == Role::robot}, *node.archive);
  const Status restored = node.core->restore(node.journal.records());
  REQUIRE_MESSAGE(restored.ok(), (restored ? "" : restored.error().text()));
  node.up = true;
  run_core(node, [&](SchedulerCore& core, Outbox& out) {
    core.on_welcome({id, node.role, 1}, now_at(nodes_.at(id)), out);
  });
}

void Fleet::run_core(Node& node, const std::function<void(SchedulerCore&, Outbox&)>& step) {
  if (!node.up) return;
  Outbox out;
  step(*node.core, out);
  carry_out(node, out);
  touch(node);
}

bool Fleet::commit(Node& node, const Outbox& out) {
  for (const std::string& name : out.counts) ++counted[name];
  if (out.journal.empty()) return true;
  for (const Journal& record : out.journal) node.journal.commit(read_back(record), *node.archive);
  return ++node.commits != node.crash_at;
}

void Fleet::carry_out(Node& node, const Outbox& out) {
  const bool crashed = !commit(node, out);
  if (!crashed || node.crash_after_sends) {
    for (const Send& one : out.sends) send(node, one);
  }
  if (!crashed) return;
  stop(node.id);
  time_.post({node.id, false, true, false, {}}, seconds(0.3));
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

void Fleet::send(Node& node, const Send& send) {
  Inbound message{send.type,     node.id,    send.target,       time_.next_number(),
                  send.reply_to, send.flags, send.remaining_ms, carried_over(send.body)};
  if (send.reply_to != 0 && asked_.contains(send.reply_to)) {
    answers.push_back(message.body);
  } else if (send.target == node.id && guests_asked_.contains(send.reply_to)) {
    time_.post({node.id, false, false, true, message}, seconds(0.001));
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
    time_.post({node.id, true, false, false, message}, seconds(0.001));
  }
}

void Fleet::answer(const std::string& from, const Inbound& asked, Duration delay, Body body) {
  time_.post({asked.source,
              false,
              false,
              false,
              {MessageType::information, from, asked.source, time_.next_number(), asked.id, 0, 1000, std::move(body)}},
             delay);
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
    route.profile.out_of_use = other.adapter.out_of_use;
    route.profile.plugged = other.sensors.infos();
    table.routes.push_back(std::move(route));
  }
  return table;
}

void Fleet::nack(Node& node, const Inbound& message, Errc code) {
  if (message.type == MessageType::information || message.reply_to != 0) return;
  Nack body{std::string(errc_name(code)), std::string(subtype_of(message.body)), message.target, "not delivered", ""};
  time_.post({node.id,
              false,
              false,
              false,
              {MessageType::information, node.id, node.id, time_.next_number(), message.id, 0, 1000, body}},
             seconds(0.001));
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
  for (const Duration delay : network_.arrivals()) {
    time_.post({message.target, false, false, false, message}, delay);
  }
}

void Fleet::happen(Event event) {
  Node& node = nodes_.at(event.node);
  if (event.starts) return start(event.node);
  if (event.to_guest || guests_asked_.contains(event.message.reply_to)) {
    return nudge(node.id, [&](Guest& guest, Now now, Outbox& out) { guest.on(event.message, now, out); });
  }
  if (event.to_adapter) {
    node.adapter.hear(event.message, time_.now());
    return run_adapter(node);
  }
  run_core(node, [&](SchedulerCore& core, Outbox& out) { core.on(event.message, now_at(node), out); });
}

void Fleet::run_adapter(Node& node) {
  node.adapter.tick(time_.now());
  for (FakeAdapter::Said& said : node.adapter.take()) {
    if (network_.loses_locally()) continue;
    const MessageType type = MessageType::information;
    time_.post({node.id,
                false,
                false,
                false,
                {type, node.id, node.id, time_.next_number(), said.reply_to, 0, 1000, std::move(said.body)}},
               seconds(0.001));
  }
  touch(node);
}

/// When something is due on that node without a message.
void Fleet::touch(Node& node) {
  std::optional<MonotonicTime> next = node.adapter.next();
  if (node.up) next = earlier(next, node.core->next_deadline());
  const auto guest = guests_.find(node.id);
  if (node.up && guest != guests_.end()) next = earlier(next, guest->second->next_deadline());
  time_.set_deadline(node.id, next);
}

bool Fleet::next_moment(MonotonicTime limit) {
  const auto next = time_.next();
  if (!next || *next > limit) return false;
  time_.pass_to(*next);
  if (auto event = time_.take_due()) happen(std::move(*event));
  for (auto& [id, node] : nodes_) {
    if (time_.is_due(id)) tick(node);
  }
  return true;
}

/// Something is due on that node without a message.
void Fleet::tick(Node& node) {
  run_adapter(node);
  const auto due = [&](std::optional<MonotonicTime> is) { return node.up && is && *is <= time_.now(); };
  if (due(node.up ? node.core->next_deadline() : std::nullopt)) {
    run_core(node, [&](SchedulerCore& core, Outbox& out) { core.tick(now_at(node), out); });
  }
  const auto guest = guests_.find(node.id);
  if (guest != guests_.end() && due(guest->second->next_deadline())) {
    nudge(node.id, [](Guest& is, Now now, Outbox& out) { is.tick(now, out); });
  }
  touch(node);
}

void Fleet::attach(const std::string& node, Guest& guest) {
  guests_[node] = &guest;
  touch(nodes_.at(node));
}

void Fleet::nudge(const std::string& id, const std::function<void(Guest&, Now, Outbox&)>& step) {
  Node& node = nodes_.at(id);
  if (!node.up) return;
  Outbox out;
  step(*guests_.at(id), now_at(node), out);
  for (const Send& one : out.sends) send_of_guest(node, one);
  touch(node);
}

void Fleet::answer_guest(Node& node, const Inbound& asked, Duration delay, const std::string& from, Body body) {
  time_.post({node.id,
              false,
              false,
              true,
              {MessageType::information, from, node.id, time_.next_number(), asked.id, 0, 1000, std::move(body)}},
             delay);
}

void Fleet::send_of_guest(Node& node, const Send& send) {
  Inbound message{send.type,     node.id,    send.target,       time_.next_number(),
                  send.reply_to, send.flags, send.remaining_ms, carried_over(send.body)};
  if (send.reply_to != 0 && asked_.contains(send.reply_to)) return answers.push_back(message.body);
  constexpr std::size_t kRemembered = 10'000;
  guests_asked_.insert(message.id);
  if (guests_asked_.size() > kRemembered) guests_asked_.erase(guests_asked_.begin());
  if (send.target != node.id) {
    Node& to = nodes_.at(send.target);
    if (node.cut || to.cut || !to.up) {
      return answer_guest(node, message, seconds(0.001), node.id,
                          Nack{"peer_unreachable", std::string(subtype_of(message.body)), send.target, "is away", ""});
    }
    if (const auto* value = get_if<Opaque>(&message.body)) {
      const auto told = to.values.find(value->subtype);
      if (told == to.values.end()) return;
      return answer_guest(node, message, seconds(0.02), to.id, Opaque{value->subtype, told->second});
    }
    if (const auto* repaired = get_if<TakeIntoUse>(&message.body)) {
      to.adapter.take_into_use(*repaired);
      run_adapter(to);
      touch(to);
      return answer_guest(node, message, seconds(0.02), to.id, Ack{"in_use", ""});
    }
  } else if (const auto* request = get_if<SignRequest>(&message.body)) {
    REQUIRE(may_sign(node.role, request->kind));
    REQUIRE(may_have_signed("resilience", false, request->kind));
    return answer_guest(node, message, seconds(0.002), node.id, sign(node.id, request->kind, request->payload.bytes));
  } else if (const auto* asked = get_if<RouteListRequest>(&message.body)) {
    return answer_guest(node, message, seconds(0.001), node.id, routes(node, asked->after));
  }
  time_.post({send.target, false, false, false, message}, seconds(0.005));
}

/// A test may have changed anything.
void Fleet::touch_all() {
  for (auto& [id, node] : nodes_) touch(node);
}

bool Fleet::until(const std::function<bool()>& done, Duration limit) {
  const MonotonicTime end = time_.now() + limit;
  while (!done()) {
    touch_all();
    if (!next_moment(end)) return done();
  }
  return true;
}

void Fleet::pass(Duration time) {
  const MonotonicTime end = time_.now() + time;
  touch_all();
  while (next_moment(end)) {
  }
  time_.pass_to(end);
}

void add_demonstration(Fleet& fleet) {
  fleet.add("cloud", Role::cloud);
  for (const char* robot : {"conveyor", "drone", "pioneer", "ridgeback", "ur3"}) fleet.add(robot, Role::robot);
}

}  // namespace trb::scheduler::test
