#include "services/resilience/core/situation.hpp"

#include <algorithm>

#include "common/base/errc.hpp"

namespace trb::resilience {
namespace {

constexpr Duration kLease = std::chrono::seconds(10);  ///< of a link between two routers

}  // namespace

const SignedRecord* Situation::certificate_of(std::string_view robot) const {
  const auto at = certificates_.find(robot);
  return at == certificates_.end() ? nullptr : &at->second;
}

bool Situation::is_missing(std::string_view robot) const {
  return judged_ && !listed_.contains(robot);
}

void Situation::forget(const std::string& robot, Now now) {
  fleet_.forget(robot, now.utc);
  certificates_.erase(robot);
  unlisted_.erase(robot);
  note_robot(robot, now);
}

bool Situation::decides_on(const WatchedRun* run) const {
  return settings_.role == Role::cloud && run != nullptr && run->decider() == settings_.node;
}

void Situation::on_welcome(const NodeIdentity& node, Now now) {
  settings_.node = node.id;
  settings_.role = node.role;
  runs_.on_welcome(node.id);
  routes_.want(now, Duration{0});
}

void Situation::receive(const RobotState& state, const std::string& robot, Now now, Outbox& out) {
  if (!fleet_.on_state(robot, state, now.utc)) out.count("dropped.robot_state");
}

void Situation::receive(const RobotFault& fault, const std::string& robot, Now now, Outbox& out) {
  const RobotRecord* known = fleet_.find(robot);
  const std::vector<Fault> before = known == nullptr ? std::vector<Fault>{} : known->faults;
  if (!fleet_.on_fault(robot, fault, now.utc)) return out.count("dropped.robot_fault");
  // A repeated identical report changes nothing for any run.
  known = fleet_.find(robot);
  if (known->faults == before) return;
  routes_.want_with_next(now);
  note_robot(robot, now);
}

void Situation::receive(const RobotConnection& connection, const std::string& robot, Now now, Outbox& out) {
  const RobotRecord* known = fleet_.find(robot);
  if (known == nullptr) return out.count("dropped.robot_connection");
  const auto told = [&] { return std::pair(known->profile.is.robot, known->profile.is.detail); };
  const auto before = told();
  fleet_.on_connection(robot, connection, now.utc);
  if (told() == before) return;
  note_robot(robot, now);
  routes_.want(now, RouteRequests::kAtOnce);
}

void Situation::receive(const PeerJoined& peer, Now now, Outbox& out) {
  routes_.want_with_next(now);
  if (fleet_.find(peer.id) == nullptr) return;  // the table shows whether it has a robot
  if (const Status known = fleet_.on_joined(peer.id, now.utc); !known) out.count("dropped.peer_joined");
  note_robot(peer.id, now);
}

void Situation::receive(const PeerExpired& peer, Now now) {
  fleet_.on_expired(peer.id, peer.reason, now.utc);
  note_robot(peer.id, now, true);
  // A run's alert tells what has become of its robot: then it is kept for a person's word.
  if (peer.reason.starts_with(errc_name(Errc::cert_revoked)) && open_tasks_.of(peer.id) == 0) forget(peer.id, now);
}

void Situation::receive(const RouteTable& table, Now now, Outbox& out) {
  const bool first = !std::exchange(judged_, true);
  liveness_.begin();
  listed_.clear();
  for (const Route& route : table.routes) {
    // A cloud node has no robot: it takes no tasks, and its certificate is the run's already.
    if (route.role != Role::robot) continue;
    const auto changed = fleet_.on_route(route, now.utc);
    if (!changed) {
      out.count("dropped.route");
      continue;
    }
    certificates_[route.id] = route.certificate;
    listed_.insert(route.id);
    fleet_.set_later_tasks(route.id, open_tasks_.of(route.id));  // the robot may be new here
    if (*changed && !first) note_robot(route.id, now);
  }
  expire_unlisted(now);
  if (first) judge_all(now);
  note_change();
}

/// A router that has started anew tells of no robot's end that came before: it has never had that robot. It first gets
/// as long to find the others as they have to be heard.
void Situation::expire_unlisted(Now now) {
  std::vector<std::string> over;
  for (const auto& [id, robot] : fleet_.robots()) {
    if (!robot.reached || listed_.contains(id)) {
      unlisted_.erase(id);
    } else if (now.mono - unlisted_.try_emplace(id, now.mono).first->second >= kLease) {
      over.push_back(id);
    }
  }
  for (const std::string& id : over) {
    fleet_.on_expired(id, "the router's table has it no more", now.utc);
    note_robot(id, now);
  }
}

void Situation::judge_all(Now now) {
  for (const auto& [id, run] : runs_.runs()) {
    due_runs_.notify(id);
    if (!run.view) continue;
    for (const TaskView& task : run.view->tasks) {
      if (!task.robot.empty()) liveness_.look(task.robot, fleet_.find(task.robot), now);
    }
  }
}

void Situation::note_robot(const std::string& robot, Now now, bool expired) {
  note_change();
  for (const auto& [id, run] : runs_.runs()) {
    if (!run.view) continue;
    const bool needed = std::ranges::any_of(run.view->tasks, [&](const TaskView& task) { return task.robot == robot; });
    if (!needed) continue;
    liveness_.look(robot, fleet_.find(robot), now, expired);
    due_runs_.notify(id);
  }
}

void Situation::count_tasks(const std::string& run) {
  for (const std::string& robot : open_tasks_.count(run, runs_.find(run))) {
    fleet_.set_later_tasks(robot, open_tasks_.of(robot));
  }
}

std::set<std::string> Situation::take_due_runs(Now now) {
  for (const std::string& run : runs_.take_changed()) {
    count_tasks(run);
    due_runs_.notify(run);
  }
  std::set<std::string> out = due_runs_.take(now.mono);
  if (!out.empty()) note_change();
  for (const std::string& id : out) {
    const WatchedRun* run = runs_.find(id);
    if (run == nullptr || !run->is_known()) continue;
    for (const TaskView& task : run->view->tasks) {
      if (!task.robot.empty()) liveness_.look(task.robot, fleet_.find(task.robot), now);
    }
  }
  return out;
}

}  // namespace trb::resilience
