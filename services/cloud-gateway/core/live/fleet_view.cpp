#include "services/cloud-gateway/core/live/fleet_view.hpp"

namespace trb::gateway {
namespace {

constexpr std::size_t kMaxAnswer = 1024;  ///< as of RobotState

}  // namespace

FleetView::FleetView(RowBook& book, AlarmDesk& alarms) : book_(book), alerts_(book, alarms) {}

std::vector<std::string> FleetView::subscriptions() {
  std::vector<std::string> out;
  for (const std::string_view word : {RobotState::kSubtype, RobotConnection::kSubtype, RobotFault::kSubtype,
                                      PeerJoined::kSubtype, PeerExpired::kSubtype, NodeSensors::kSubtype}) {
    out.emplace_back(word);
  }
  return out;
}

void FleetView::on_welcome(const std::string& node, Now now) {
  node_ = node;
  questions_.on_welcome(node, now);
  streams_.on_welcome(now);
}

void FleetView::on(const Inbound& message, Now now, Outbox& out) {
  if (message.type != MessageType::information) return;
  if (!on_robot(message, now, out) && !on_own_node(message, now, out)) out.count("dropped.unexpected");
}

/// False: another kind of message. The source is authenticated, so a node reports only on its own robot.
bool FleetView::on_robot(const Inbound& message, Now now, Outbox& out) {
  const std::string& from = message.source;
  const auto take = [&](const auto& word) { return nodes_.take_report(from, word, now, out), true; };
  return visit(
      Overloaded{[&](const RobotState& word) { return take(word); }, [&](const RobotFault& word) { return take(word); },
                 [&](const RobotConnection& word) { return questions_.want_routes(now), take(word); },
                 [&](const SensorReading& reading) { return on_reading(from, reading, now, out), true; },
                 [&](const Opaque& answer) { return on_answer(from, answer, now, out), true; },
                 [](const auto&) { return false; }},
      message.body);
}

void FleetView::on_answer(const std::string& robot, const Opaque& answer, Now now, Outbox& out) {
  if (!robots_.has_asked(robot, answer.subtype) || answer.data.size() > kMaxAnswer)
    return out.count("dropped.not_asked");
  nodes_.take_report(robot, RobotState{{{answer.subtype, answer.data}}}, now, out);
}

/// What was under way when its stream ended would bring back a value that nobody keeps up to date.
void FleetView::on_reading(const std::string& node, const SensorReading& reading, Now now, Outbox& out) {
  if (!streams_.has({node, reading.sensor})) return out.count("dropped.not_watched");
  readings_.take(node, reading, nodes_.live_of(node), now, out);
}

/// False: another kind of message. Messages of other nodes are dropped.
bool FleetView::on_own_node(const Inbound& message, Now now, Outbox& out) {
  const bool own = message.source == node_;
  const auto take = [&](const auto& effect) { return own ? effect() : out.count("dropped.foreign"), true; };
  const auto received = [&](Source& source) { source.heard = now.mono; };
  return visit(
      Overloaded{
          [&](const RouteTable& page) { return take([&] { on_page(page, now, out); }); },
          [&](const PeerJoined& body) {
            return take([&] { nodes_.take(body, now, out), questions_.want_routes(now); });
          },
          [&](const PeerExpired& body) { return take([&] { nodes_.take(body, now), questions_.want_routes(now); }); },
          [&](const NodeSensors& body) { return take([&] { nodes_.take(node_, body.sensors, now, out); }); },
          [&](const RunTable& body) { return take([&] { received(runs_heard_), on_runs(body, now, out); }); },
          [&](const RunChanged& body) { return take([&] { on_run(body, now, out); }); },
          [&](const RunView& body) { return take([&] { questions_.drop_run(body.run), runs_.take(body, now, out); }); },
          [&](const AlertTable& body) { return take([&] { received(alerts_heard_), alerts_.take(body, now, out); }); },
          [](const auto&) { return false; }},
      message.body);
}

void FleetView::on_page(const RouteTable& page, Now now, Outbox& out) {
  RoutePages::Taken taken = pages_.take(page);
  if (taken.next) out.request(node_, std::move(*taken.next));
  if (!taken.whole) return;
  routes_heard_.heard = now.mono;
  nodes_.take(std::move(*taken.whole), now, out);
}

/// A run's state and what it waits for also change without a new version of the run, and only the table says so.
void FleetView::on_runs(const RunTable& table, Now now, Outbox& out) {
  std::map<std::string, std::uint64_t> before;
  for (const std::string& run : watched_runs_) before[run] = version_of(run);
  runs_.take(table, now, out);
  for (const auto& [run, version] : before) {
    if (version_of(run) != version) questions_.want_run(run, now);
  }
}

/// 0: the run has no row.
std::uint64_t FleetView::version_of(const std::string& run) const {
  const Row* row = book_.find({RowKind::run, {}, run});
  return row == nullptr ? 0 : row->version;
}

void FleetView::on_run(const RunChanged& changed, Now now, Outbox& out) {
  runs_.take(changed, now, out);
  if (watched_runs_.contains(changed.run.run)) questions_.want_run(changed.run.run, now);
}

void FleetView::watch_runs(std::set<std::string> runs, Now now) {
  for (const std::string& run : runs) {
    if (!watched_runs_.contains(run)) questions_.want_run(run, now);
  }
  watched_runs_ = std::move(runs);
}

void FleetView::watch_sensors(const std::set<SensorId>& sensors, Now now) {
  for (const SensorId& over : streams_.want(sensors, now)) book_.remove({RowKind::reading, over.node, over.name}, now);
}

void FleetView::tick(Now now, Outbox& out) {
  watch_silence(now);
  streams_.tick(now, out);
  robots_.tick(now, out);
  readings_.tick(now);
  book_.tick(now);
  look_for_lost(now);
  questions_.tick(now, out);
}

/// Removes a lost run if the scheduler does not answer; requests the others.
void FleetView::look_for_lost(Now now) {
  for (const std::string& run : questions_.take_given_up()) {
    if (runs_.lost().contains(run)) runs_.forget(run, now);
  }
  for (const std::string& run : runs_.lost()) questions_.want_run(run, now);
}

void FleetView::watch_silence(Now now) {
  const auto end = [&](Source& source, auto& rows) {
    if (!source.is_over(now)) return;
    source.heard.reset();
    rows.on_silence(now);
  };
  end(routes_heard_, nodes_);
  end(runs_heard_, runs_);
  end(alerts_heard_, alerts_);
}

RowSources FleetView::silent() const {
  RowSources out;
  for (const Source* source : {&routes_heard_, &runs_heard_, &alerts_heard_}) {
    if (!source->heard) out.push_back(source->name);
  }
  return out;
}

std::optional<MonotonicTime> FleetView::next_deadline() const {
  std::optional<MonotonicTime> out = earlier(questions_.next_deadline(), readings_.next_deadline());
  for (const Source* source : {&routes_heard_, &runs_heard_, &alerts_heard_}) {
    if (source->heard) out = earlier(out, *source->heard + source->limit);
  }
  return earlier(earlier(earlier(out, streams_.next_deadline()), robots_.next_deadline()), book_.next_deadline());
}

}  // namespace trb::gateway
