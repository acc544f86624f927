#include "services/resilience/core/resilience_core.hpp"

#include <algorithm>

namespace trb::resilience {
namespace {

constexpr Duration kRoutes = std::chrono::seconds(30);
constexpr Duration kRoutesWhileOpen = std::chrono::seconds(5);
constexpr Duration kRoutesAtOnce = std::chrono::seconds(1);
constexpr Duration kLook = std::chrono::seconds(1);

}  // namespace

std::vector<std::string> ResilienceCore::hears() {
  std::vector<std::string> out;
  for (const std::string_view word : {RobotFault::kSubtype, RobotConnection::kSubtype, RobotState::kSubtype,
                                      PeerJoined::kSubtype, PeerExpired::kSubtype}) {
    out.emplace_back(word);
  }
  return out;
}

void ResilienceCore::restore(std::vector<Alert> alerts, const std::vector<StoredDecision>& decisions) {
  for (Alert& alert : alerts) book_.restore(std::move(alert));
  book_.prune();
  for (const auto& [id, robot] : fleet_.robots()) fleet_.set_later_tasks(id, 0);  // the runs say it anew
  for (const StoredDecision& stored : decisions) {
    const auto decision = decode<Decision>(stored.record.payload.bytes);
    if (stored.delivered || !decision) continue;
    const Alert* alert = book_.find(decision->alert);
    if (alert == nullptr || alert->state != AlertState::releasing) continue;
    Work& work = works_[alert->id];
    work.record = stored.record;
    work.epoch = decision->epoch;
  }
}

void ResilienceCore::on_welcome(const NodeIdentity& node, Now now, Outbox& out) {
  welcomed_ = true;
  settings_.node = node.id;
  settings_.role = node.role;
  watcher_.on_welcome(node.id, now);
  ask_routes_at_ = now.mono;
  settle(now, out);
}

void ResilienceCore::on(const Inbound& message, Now now, Outbox& out) {
  if (message.type == MessageType::information) {
    on_information(message, now, out);
  } else {
    on_request(message, now, out);
  }
  settle(now, out);
}

void ResilienceCore::on_request(const Inbound& message, Now now, Outbox& out) {
  stirred_ = true;
  if (Taken::dispatch(message.body, [&](const auto& body) { handle(body, message, now, out); })) return;
  out.count("refused.unexpected");
  out.nack(message,
           fail(Errc::unknown_subtype, "trb-resilience does not take '" + std::string(subtype_of(message.body)) + "'"));
}

void ResilienceCore::on_information(const Inbound& message, Now now, Outbox& out) {
  const std::string& from = message.source;
  const bool own = from == settings_.node;
  visit(Overloaded{[&](const RobotState& body) {
                     if (!fleet_.on_state(from, body, now.utc)) out.count("dropped.robot_state");
                   },
                   [&](const RobotFault& body) { hear(body, from, now, out); },
                   [&](const RobotConnection& body) {
                     if (!fleet_.on_connection(from, body, now.utc)) out.count("dropped.robot_connection");
                     look_at_robot(from, now);
                     ask_routes(now, kRoutesAtOnce);
                   },
                   [&](const PeerJoined& body) {
                     if (!own) return out.count("dropped.foreign");
                     ask_routes(now, kRoutesAtOnce);
                     if (fleet_.find(body.id) == nullptr) return;  // the table says whether it has a robot
                     if (const Status known = fleet_.on_joined(body.id, now.utc); !known)
                       out.count("dropped.peer_joined");
                     look_at_robot(body.id, now);
                   },
                   [&](const PeerExpired& body) {
                     if (!own) return out.count("dropped.foreign");
                     fleet_.on_expired(body.id, body.reason, now.utc);
                     look_at_robot(body.id, now, true);
                   },
                   [&](const RouteTable& body) { own ? take_page(body, now, out) : out.count("dropped.foreign"); },
                   [&](const RunTable& body) { own ? watcher_.on(body, now) : out.count("dropped.foreign"); },
                   [&](const RunChanged& body) { own ? watcher_.on(body, now) : out.count("dropped.foreign"); },
                   [&](const RunView& body) { own ? watcher_.on(body) : out.count("dropped.foreign"); },
                   [&](const Definition& body) { own ? watcher_.on(body) : out.count("dropped.foreign"); },
                   [&](const auto&) { on_answer(message, now, out); }},
        message.body);
}

void ResilienceCore::on_answer(const Inbound& message, Now now, Outbox& out) {
  const std::string& from = message.source;
  const bool own = from == settings_.node;
  visit(Overloaded{[&](const SignedRecord& body) { own ? on_signed(body, out) : out.count("dropped.foreign"); },
                   // Of the own scheduler: it has taken a decision or an order; what came of it the view tells.
                   [&](const Ack& body) {
                     if (!own && body.state == "in_use") return hear_taken(from, now);
                     const Alert* alert = own ? book_.find(handed_) : nullptr;
                     if (alert != nullptr) watcher_.refresh(alert->run);
                   },
                   // Nobody refuses in the own scheduler's place.
                   [&](const Nack& body) {
                     const bool asked_here =
                         body.subtype == RunDecision::kSubtype || body.subtype == RunAbort::kSubtype;
                     const bool of_robot = body.subtype == TakeIntoUse::kSubtype;
                     if (of_robot) return hear_unmended(body, from, now, out);
                     own || !asked_here ? hear(body, now, out) : out.count("dropped.foreign");
                   },
                   [&](const Opaque& body) {
                     message.reply_to != 0 ? hear(body, from, now, out) : out.count("dropped.unexpected");
                   },
                   [&](const SensorReading& body) {
                     message.reply_to != 0 ? hear(body, from, now, out) : out.count("dropped.unexpected");
                   },
                   [&](const auto&) { out.count("dropped.unexpected"); }},
        message.body);
}

void ResilienceCore::hear(const RobotFault& fault, const std::string& robot, Now now, Outbox& out) {
  const RobotRecord* known = fleet_.find(robot);
  const std::vector<Fault> before = known == nullptr ? std::vector<Fault>{} : known->faults;
  if (!fleet_.on_fault(robot, fault, now.utc)) return out.count("dropped.robot_fault");
  // Told again in the same words it changes nothing for any run.
  known = fleet_.find(robot);
  if (known->faults != before) {
    ask_routes(now, kRoutesAtOnce);
    look_at_robot(robot, now);
  }
}

void ResilienceCore::take_page(const RouteTable& page, Now now, Outbox& out) {
  auto taken = routes_.take(page);
  if (taken.whole) return hear(*taken.whole, now, out);
  if (taken.next) out.request(settings_.node, std::move(*taken.next));
}

void ResilienceCore::hear(const RouteTable& table, Now now, Outbox& out) {
  const bool first = !std::exchange(routes_heard_, true);
  answered(settings_.node, std::string(RouteListRequest::kSubtype));
  presence_.begin();
  for (const Route& route : table.routes) {
    // A cloud node has no robot: it takes no tasks, and its certificate is the run's already.
    if (route.role != Role::robot) continue;
    const auto changed = fleet_.on_route(route, now.utc);
    if (!changed) {
      out.count("dropped.route");
      continue;
    }
    certificates_[route.id] = route.certificate;
    fleet_.set_later_tasks(route.id, open_tasks_.of(route.id));  // it may be new here
    if (*changed && !first) look_at_robot(route.id, now);
  }
  if (first) judge_all(now);
  stirred_ = true;
}

/// The first table has come: before, nobody was known to be gone.
void ResilienceCore::judge_all(Now now) {
  for (const auto& [id, run] : watcher_.runs()) {
    due_runs_.notify(id);
    if (!run.view) continue;
    for (const TaskView& task : run.view->tasks) {
      if (!task.robot.empty()) presence_.look(task.robot, fleet_.find(task.robot), now);
    }
  }
}

void ResilienceCore::hear(const Nack& nack, Now now, Outbox& out) {
  answered(nack.target, nack.subtype);
  if (nack.subtype == SensorRead::kSubtype) refused_reading(nack.target);
  if (nack.subtype == RunDecision::kSubtype || nack.subtype == RunAbort::kSubtype) {
    out.count("nacked." + nack.subtype);
    out.log(LogLevel::warning, "decision_refused", nack.code + ": " + nack.what);
    Alert* alert = book_.find(handed_);
    if (alert == nullptr || !is_open(*alert)) return;  // late
    // What is only not delivered is sent again.
    constexpr Errc kNotDelivered[] = {Errc::no_service, Errc::queue_full, Errc::expired, Errc::timeout};
    const auto code = errc_of(nack.code);
    if (!code || std::ranges::find(kNotDelivered, *code) == std::end(kNotDelivered)) {
      works_[alert->id].refusal = nack.what;
    }
    return watcher_.refresh(alert->run);
  }
  if (nack.subtype == ReleaseTasks::kSubtype || nack.subtype == SignRequest::kSubtype) {
    out.count("nacked." + nack.subtype);
    return out.log(LogLevel::warning, "not_yet", nack.subtype + " to '" + nack.target + "': " + nack.what);
  }
  for (const std::string_view word : {RunWatch::kSubtype, RunQuery::kSubtype, NeedDefinition::kSubtype}) {
    if (nack.subtype == word) watcher_.on_nack(nack, now, out);
  }
}

/// Something about the robot is another than before: its runs are looked at.
void ResilienceCore::look_at_robot(const std::string& robot, Now now, bool expired) {
  stirred_ = true;
  for (const auto& [id, run] : watcher_.runs()) {
    if (!run.view) continue;
    const bool needed = std::ranges::any_of(run.view->tasks, [&](const TaskView& task) { return task.robot == robot; });
    if (!needed) continue;
    presence_.look(robot, fleet_.find(robot), now, expired);
    due_runs_.notify(id);
  }
}

void ResilienceCore::ask_routes(Now now, Duration at_most_every) {
  const MonotonicTime at = asked_routes_ ? std::max(now.mono, *asked_routes_ + at_most_every) : now.mono;
  ask_routes_at_ = earlier(ask_routes_at_, at);
}

void ResilienceCore::tick(Now now, Outbox& out) {
  settle(now, out);
}

/// At what has changed, and once a second at what is open.
void ResilienceCore::look(Now now, Outbox& out) {
  const bool due = look_at_ && *look_at_ <= now.mono;
  look_at_runs(now, out);
  if (!stirred_ && !due) return;
  stirred_ = false;
  looked_at_ = now.mono;
  look_at_alerts(now, out);
  tell_standing(now, out);
}

/// The end of every step.
void ResilienceCore::settle(Now now, Outbox& out) {
  if (!welcomed_) return;
  if (routes_heard_) look(now, out);
  const bool open = !book_.open().empty();
  look_at_ = open && looked_at_ ? std::optional(*looked_at_ + kLook) : std::nullopt;
  for (const auto& [id, work] : works_) {
    const auto follow_at = work.heard_at ? std::optional(*work.heard_at + kCrowd) : std::nullopt;
    if (follow_at && *follow_at > now.mono) look_at_ = earlier(look_at_, follow_at);
    for (const Backoff* backoff : {&work.release, &work.sign, &work.hand, &work.mend}) {
      if (backoff->next() && *backoff->next() > now.mono) look_at_ = earlier(look_at_, backoff->next());
    }
  }
  if (routes_heard_) look_at_ = earlier(look_at_, due_runs_.next());
  standing_.follow(fleet_, now);
  look_at_ = earlier(earlier(look_at_, presence_.next(now)), standing_.next(now));
  if (routes_heard_ && due_runs_.has_notified()) look_at_ = now.mono;
  // Only the table tells of a profile that has changed: that a robot is retired or has returned, say.
  if (open || fleet_.has_retired() || !watcher_.runs().empty()) ask_routes(now, kRoutesWhileOpen);
  // Who is not there may be there again, and its word of it have been lost with a link that was just being built.
  if (presence_.next(now)) ask_routes(now, kRoutesAtOnce);
  if (ask_routes_at_ && *ask_routes_at_ <= now.mono) {
    out.request(settings_.node, RouteListRequest{});
    asked_routes_ = now.mono;
    // Without a first table nothing is judged: whatever has kept it away, it is asked for again soon.
    ask_routes_at_ = now.mono + (routes_heard_ ? kRoutes : kRoutesAtOnce);
  }
  watcher_.tick(now, out);
}

std::optional<MonotonicTime> ResilienceCore::next_deadline() const {
  if (!welcomed_) return std::nullopt;
  return earlier(earlier(look_at_, ask_routes_at_), watcher_.next_deadline());
}

}  // namespace trb::resilience
