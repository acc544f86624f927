#include "services/cloud-gateway/core/live/robot_questions.hpp"

#include <algorithm>
#include <vector>

#include "common/fleet/charge.hpp"

namespace trb::gateway {
namespace {

bool is_reached(const Row& row) {
  return row.live == Live::live && std::get<RobotRow>(row.content).connection == "ONLINE";
}

/// All robots that can be asked, the one behind `last` first.
std::vector<const Row*> robots_after(const RowBook& book, const std::string& last) {
  std::vector<const Row*> out;
  book.each(RowKind::robot, [&](const Row& row) {
    if (is_reached(row)) out.push_back(&row);
  });
  std::ranges::sort(out, {}, [](const Row* row) { return row->key.node; });
  const auto first = std::ranges::find_if(out, [&](const Row* row) { return row->key.node > last; });
  std::rotate(out.begin(), first, out.end());
  return out;
}

bool is_due(std::optional<MonotonicTime>& at, Duration every, Now now) {
  if (at && now.mono - *at < every) return false;
  at = now.mono;
  return true;
}

}  // namespace

void RobotQuestions::want(bool wanted, Now now) {
  if (wanted == at_.has_value()) return;
  asked_.clear();
  at_ = wanted ? std::optional(now.mono) : std::nullopt;
}

void RobotQuestions::tick(Now now, Outbox& out) {
  if (!at_ || now.mono < *at_) return;
  at_ = now.mono + kStep;
  forget_missing();
  std::size_t sent = 0;
  for (const Row* robot : robots_after(book_, last_)) {
    if (sent >= kMostAtOnce) return;
    last_ = robot->key.node;
    const Row* profile = book_.find({RowKind::profile, robot->key.node, {}});
    if (profile != nullptr) sent += ask(*robot, std::get<NodeProfile>(profile->content), now, out);
  }
}

Duration RobotQuestions::pause_of(const Row& robot, Asked& asked, Now now) const {
  const Row* teleop = book_.find({RowKind::teleop, robot.key.node, {}});
  const bool is_driven = teleop != nullptr && !std::get<TeleopRow>(teleop->content).holder.empty();
  if (is_driven || !std::get<RobotRow>(robot.content).control.empty()) asked.commanded = now.mono;
  if (is_driven) return kDriven;
  return asked.commanded && now.mono - *asked.commanded < kComesToStand ? kCommanded : kStanding;
}

std::size_t RobotQuestions::ask(const Row& robot, const NodeProfile& profile, Now now, Outbox& out) {
  if (!moves(profile)) return 0;
  Asked& asked = asked_[robot.key.node];
  std::size_t sent = 0;
  if (is_due(asked.position, pause_of(robot, asked, now), now)) {
    out.request(robot.key.node, Opaque{std::string(kPositionRequest), ""});
    ++sent;
  }
  if (is_due(asked.charge, kCharge, now)) {
    asked.charge_name = charge_request(profile);
    out.request(robot.key.node, Opaque{asked.charge_name, ""});
    ++sent;
  }
  return sent;
}

void RobotQuestions::forget_missing() {
  std::erase_if(asked_, [&](const auto& one) { return book_.find({RowKind::robot, one.first, {}}) == nullptr; });
}

bool RobotQuestions::has_asked(const std::string& robot, const std::string& value) const {
  const auto at = asked_.find(robot);
  return at != asked_.end() && (value == kPositionRequest || value == at->second.charge_name);
}

}  // namespace trb::gateway
