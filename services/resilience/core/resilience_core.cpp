#include "services/resilience/core/resilience_core.hpp"

#include <algorithm>

#include "proto/value.hpp"

namespace trb::resilience {
namespace {

constexpr Duration kLook = std::chrono::seconds(1);
constexpr Duration kShown = std::chrono::minutes(15);  ///< how long a lesser fault is shown
constexpr std::uint32_t kMostEvents = 500;             ///< the bound of a HistoryTable

}  // namespace

std::vector<std::string> ResilienceCore::subscriptions() {
  std::vector<std::string> out;
  for (const std::string_view word : {RobotFault::kSubtype, RobotConnection::kSubtype, RobotState::kSubtype,
                                      PeerJoined::kSubtype, PeerExpired::kSubtype}) {
    out.emplace_back(word);
  }
  return out;
}

void ResilienceCore::restore(std::vector<Alert> alerts, const std::vector<StoredDecision>& decisions) {
  for (const auto& [id, robot] : fleet().robots()) fleet().set_later_tasks(id, 0);  // the runs report it anew
  parts_.alerts.restore(std::move(alerts), decisions);
}

void ResilienceCore::on_welcome(const NodeIdentity& node, Now now, Outbox& out) {
  welcomed_ = true;
  parts_.situation.on_welcome(node, now);
  settle(now, out);
}

void ResilienceCore::on(const Inbound& message, Now now, Outbox& out) {
  if (!holds_alternative<AlertListRequest>(message.body)) told_.reset();
  if (message.type == MessageType::information) {
    on_information(message, now, out);
  } else {
    on_request(message, now, out);
  }
  settle(now, out);
}

// ---- requests and verdicts of people

void ResilienceCore::on_request(const Inbound& message, Now now, Outbox& out) {
  if (Taken::dispatch(message.body, [&](const auto& body) { handle(body, message, now, out); })) return;
  out.count("refused.unexpected");
  out.nack(message,
           fail(Errc::unknown_subtype, "trb-resilience does not take '" + std::string(subtype_of(message.body)) + "'"));
}

void ResilienceCore::handle(const AlertListRequest& body, const Inbound& from, Now now, Outbox& out) {
  for (Alert* alert : parts_.alerts.open()) {
    const WatchedRun* run = parts_.situation.runs().find(alert->run);
    // The proposals of an expired alert are old.
    const bool is_old = alert->state == AlertState::expired && run != nullptr && run->is_known() && !run->recovers();
    if (!is_old || !parts_.alerts.work(alert->id).inquiry.may_rank(now)) continue;
    parts_.proposer.propose(*alert, *run, now);
    parts_.situation.note_change();
    told_.reset();
  }
  // However often it is asked for, it is made once while nothing happens.
  if (!told_ || told_->all != body.all || now.mono - told_->at >= kLook)
    told_ = {make_table(body.all, now), body.all, now.mono};
  out.reply(from, told_->table);
}

AlertTable ResilienceCore::make_table(bool all, Now now) {
  AlertTable table = parts_.alerts.book().table(all);
  for (Alert& lesser : lesser_faults(fleet(), now.utc - kShown)) {
    if (table.alerts.size() == AlertBook::kMaxTable) break;
    table.alerts.push_back(std::move(lesser));
  }
  return table;
}

void ResilienceCore::handle(const AlertDecide& body, const Inbound& from, Now now, Outbox& out) {
  if (from.source == parts_.situation.node()) {
    if (auto other = parts_.verdicts.elsewhere(body)) return out.reply(from, std::move(*other));
  }
  const auto taken = parts_.verdicts.receive(body, from.source, now, out);
  if (taken) parts_.situation.note_change();
  if (taken) return out.reply(from, Ack{"accepted", cut_utf8(*taken, 1024)});
  out.count("refused.alert_decide." + std::string(errc_name(taken.error().code)));
  out.nack(from, taken.error());
}

void ResilienceCore::handle(const AlertRankRequest& body, const Inbound& from, Now now, Outbox& out) {
  const auto alert = parts_.alerts.book().choose(body.alert);
  if (!alert) return out.nack(from, alert.error());
  auto ranking = parts_.proposer.rank_by(**alert, body.weights, now, out);
  if (!ranking) return out.nack(from, ranking.error());
  out.reply(from, std::move(*ranking));
}

void ResilienceCore::handle(const HistoryListRequest& body, const Inbound& from, Now, Outbox& out) const {
  if (history_ == nullptr) return out.nack(from, fail(Errc::no_service, "this node keeps no history"));
  if (body.most == 0 || body.most > kMostEvents) {
    return out.nack(from, fail(Errc::bad_value, "most: " + std::to_string(body.most), "use 1 to 500"));
  }
  const auto entries = history_->history(body.robot, body.most);
  if (!entries) return out.nack(from, entries.error());
  if (entries->empty() && !body.robot.empty() && parts_.situation.fleet().find(body.robot) == nullptr) {
    return out.nack(from, fail(Errc::unknown_target, "'" + body.robot + "' is not known", "trb robot list"));
  }
  HistoryTable table;
  for (const HistoryEntry& one : *entries) table.events.push_back({one.time.ns, one.robot, one.kind, one.text});
  out.reply(from, std::move(table));
}

// ---- information from the fleet, the own router and the own scheduler

void ResilienceCore::on_information(const Inbound& message, Now now, Outbox& out) {
  if (!on_fleet(message, now, out) && !on_own_node(message, now, out)) on_answer(message, now, out);
}

/// False: it is another subtype.
bool ResilienceCore::on_fleet(const Inbound& message, Now now, Outbox& out) {
  const std::string& from = message.source;
  return visit(
      Overloaded{[&](const RobotState& body) { return parts_.situation.receive(body, from, now, out), true; },
                 [&](const RobotFault& body) { return parts_.situation.receive(body, from, now, out), true; },
                 [&](const RobotConnection& body) { return parts_.situation.receive(body, from, now, out), true; },
                 [&](const auto&) { return false; }},
      message.body);
}

/// False: it is another subtype. From another node it is dropped.
bool ResilienceCore::on_own_node(const Inbound& message, Now now, Outbox& out) {
  RunWatcher& runs = parts_.situation.runs();
  const bool own = message.source == parts_.situation.node();
  const auto take = [&](const auto& effect) {
    own ? effect() : out.count("dropped.foreign");
    return true;
  };
  return visit(
      Overloaded{[&](const PeerJoined& body) { return take([&] { parts_.situation.receive(body, now, out); }); },
                 [&](const PeerExpired& body) { return take([&] { parts_.situation.receive(body, now); }); },
                 [&](const RouteTable& body) { return take([&] { receive(body, now, out); }); },
                 [&](const RunTable& body) { return take([&] { runs.on(body, now); }); },
                 [&](const RunChanged& body) { return take([&] { runs.on(body, now); }); },
                 [&](const RunView& body) { return take([&] { runs.on(body); }); },
                 [&](const Definition& body) { return take([&] { runs.on(body); }); },
                 [&](const SignedRecord& body) { return take([&] { parts_.decisions.receive(body, out); }); },
                 [&](const auto&) { return false; }},
      message.body);
}

void ResilienceCore::on_answer(const Inbound& message, Now now, Outbox& out) {
  const std::string& from = message.source;
  const bool asked = message.reply_to != 0;
  const auto unexpected = [&] { out.count("dropped.unexpected"); };
  visit(
      Overloaded{
          [&](const Ack& body) { receive(body, from, now); }, [&](const Nack& body) { receive(body, from, now, out); },
          [&](const Opaque& body) { asked ? parts_.proposer.receive(body, from, now, out) : unexpected(); },
          [&](const SensorReading& body) { asked ? parts_.proposer.receive(body, from, now, out) : unexpected(); },
          [&](const auto&) { unexpected(); }},
      message.body);
}

void ResilienceCore::receive(const RouteTable& page, Now now, Outbox& out) {
  const auto table = parts_.situation.routes().receive(page, parts_.situation.node(), out);
  if (!table) return;
  parts_.alerts.on_answer(parts_.situation.node(), std::string(RouteListRequest::kSubtype));
  parts_.situation.receive(*table, now, out);
}

void ResilienceCore::receive(const Ack& ack, const std::string& from, Now now) {
  const bool own = from == parts_.situation.node();
  if (own) return parts_.decisions.on_accepted();
  if (ack.state == "in_use") parts_.repairs.on_taken(from, now);
}

void ResilienceCore::receive(const Nack& nack, const std::string& from, Now now, Outbox& out) {
  if (nack.subtype == TakeIntoUse::kSubtype) return parts_.repairs.on_refused(nack, from, now, out);
  const auto is_of = [&](const auto&... words) { return ((nack.subtype == words) || ...); };
  const bool of_decision = is_of(RunDecision::kSubtype, RunAbort::kSubtype);
  const bool of_runs = is_of(RunWatch::kSubtype, RunQuery::kSubtype, NeedDefinition::kSubtype);
  // A node refuses for itself; the own router reports what did not arrive. Only the own scheduler may refuse a
  // decision.
  const bool own = from == parts_.situation.node();
  if (!own && (of_decision || of_runs || from != nack.target)) return out.count("dropped.foreign");
  parts_.alerts.on_answer(nack.target, nack.subtype);
  if (nack.subtype == SensorRead::kSubtype) parts_.proposer.on_reading_refused(nack.target, nack.about);
  if (of_decision) return parts_.decisions.on_refused(nack, out);
  if (of_runs) return parts_.situation.runs().on_nack(nack, now, out);
  if (is_of(ReleaseTasks::kSubtype, SignRequest::kSubtype)) {
    out.count("nacked." + nack.subtype);
    out.log(LogLevel::warning, "not_yet", nack.subtype + " to '" + nack.target + "': " + nack.what);
  }
}

// ---- the end of each step

void ResilienceCore::tick(Now now, Outbox& out) {
  settle(now, out);
}

/// Looks at what has changed, and once a second at what is open.
void ResilienceCore::look(Now now, Outbox& out) {
  const bool due = look_at_ && *look_at_ <= now.mono;
  parts_.detection.look(now, out);
  if (!parts_.situation.take_change() && !due) return;
  looked_at_ = now.mono;
  told_.reset();
  look_at_alerts(now, out);
  parts_.standing.raise_due(now, out);
}

void ResilienceCore::look_at_alerts(Now now, Outbox& out) {
  for (Alert* alert : parts_.alerts.open()) {
    if (alert->run.empty()) {
      parts_.standing.look(*alert, now, out);
    } else if (alert->state == AlertState::releasing) {
      parts_.decisions.advance(*alert, now, out);
    } else {
      parts_.alert_updater.look(*alert, now, out);
    }
  }
  parts_.alerts.forget_over(out);
  parts_.alerts.book().prune();
}

void ResilienceCore::settle(Now now, Outbox& out) {
  if (!welcomed_) return;
  const bool judged = parts_.situation.is_judged();
  if (judged) look(now, out);
  schedule_look(now);
  want_routes(now);
  // Without a first table nothing is judged: it is requested again soon.
  parts_.situation.routes().tick(parts_.situation.node(), judged ? RouteRequests::kIdle : RouteRequests::kAtOnce, now,
                                 out);
  parts_.situation.runs().tick(now, out);
}

void ResilienceCore::schedule_look(Now now) {
  const DueRuns& due = parts_.situation.due_runs();
  look_at_ = !parts_.alerts.open().empty() && looked_at_ ? std::optional(*looked_at_ + kLook) : std::nullopt;
  look_at_ = earlier(look_at_, parts_.alerts.next(now));
  look_at_ = earlier(earlier(look_at_, parts_.situation.liveness().next(now)), parts_.standing.next(now));
  if (!parts_.situation.is_judged()) return;
  look_at_ = due.has_notified() ? std::optional(now.mono) : earlier(look_at_, due.next());
}

void ResilienceCore::want_routes(Now now) {
  // Only the table reports a changed profile: for example that a robot was retired or has returned.
  const bool often = !parts_.alerts.open().empty() || fleet().has_retired() || !parts_.situation.runs().runs().empty();
  if (often) parts_.situation.routes().want(now, RouteRequests::kWhileOpen);
  // A robot that was gone may be back, and its report lost with a link that was just coming up.
  if (parts_.situation.liveness().next(now)) parts_.situation.routes().want(now, RouteRequests::kAtOnce);
}

std::optional<MonotonicTime> ResilienceCore::next_deadline() const {
  if (!welcomed_) return std::nullopt;
  return earlier(earlier(look_at_, parts_.situation.routes().next_deadline()), parts_.situation.runs().next_deadline());
}

}  // namespace trb::resilience
