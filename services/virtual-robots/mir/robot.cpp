#include "services/virtual-robots/mir/robot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace trb::virtual_robots::mir {
namespace {

constexpr std::size_t kMostEntries = 1000;
constexpr double kPercentASecond = 0.005;
constexpr double kStep = 0.1;

std::string guid_of(std::size_t number) {
  char text[48];
  std::snprintf(text, sizeof text, "mirconst-guid-0000-%04zu-missions0000", number);
  return text;
}

}  // namespace

const char* name_of(QueueState state) {
  switch (state) {
    case QueueState::pending:
      return "Pending";
    case QueueState::executing:
      return "Executing";
    case QueueState::done:
      return "Done";
    case QueueState::aborted:
      break;
  }
  return "Aborted";
}

Robot::Robot(RobotSettings settings) : settings_(std::move(settings)), battery_(settings_.battery) {
  for (const auto& [name, position] : settings_.positions)
    missions_.push_back({guid_of(missions_.size() + 1), "Go to " + name, position});
}

State Robot::state() const {
  if (emergency_) return State::emergency_stop;
  if (std::any_of(errors_.begin(), errors_.end(), [](const RobotError& error) { return error.stops; }))
    return State::error;
  if (paused_) return State::pause;
  return waiting_.empty() ? State::ready : State::executing;
}

const QueueEntry* Robot::current() const {
  return waiting_.empty() ? nullptr : &entries_.at(waiting_.front());
}

const Mission* Robot::mission_of(const QueueEntry& entry) const {
  const auto at =
      std::find_if(missions_.begin(), missions_.end(), [&](const Mission& one) { return one.guid == entry.mission; });
  return at == missions_.end() ? nullptr : &*at;
}

double Robot::to_go() const {
  const QueueEntry* entry = current();
  if (entry == nullptr) return 0;
  const Position& to = mission_of(*entry)->to;
  return std::hypot(to.x - at_.x, to.y - at_.y);
}

void Robot::advance(double now) {
  double left = std::max(0.0, now - last_);
  last_ = now;
  battery_ = std::max(0.0, battery_ - left * kPercentASecond);
  while (state() == State::executing) {
    QueueEntry& entry = entries_.at(waiting_.front());
    const Mission& mission = *mission_of(entry);
    if (entry.state == QueueState::pending) {
      entry.state = QueueState::executing;
      events_.push_back("mission " + std::to_string(entry.id) + " " + mission.name);
    }
    const double way = to_go();
    if (way > left * settings_.speed_m_s) {
      const double part = left * settings_.speed_m_s / way;
      at_.orientation = std::atan2(mission.to.y - at_.y, mission.to.x - at_.x) * 180 / M_PI;
      at_.x += (mission.to.x - at_.x) * part;
      at_.y += (mission.to.y - at_.y) * part;
      return;
    }
    left -= way / settings_.speed_m_s;
    at_ = mission.to;
    end(QueueState::done, "Mission completed");
  }
}

std::optional<double> Robot::next_deadline() const {
  if (state() != State::executing) return std::nullopt;
  return last_ + std::min(kStep, std::max(to_go() / settings_.speed_m_s, 0.001));
}

const QueueEntry* Robot::queue(const std::string& mission) {
  if (std::none_of(missions_.begin(), missions_.end(), [&](const Mission& one) { return one.guid == mission; }))
    return nullptr;
  forget_old();
  const std::int64_t id = ++last_id_;
  waiting_.push_back(id);
  return &(entries_[id] = {id, mission, QueueState::pending, ""});
}

void Robot::forget_old() {
  while (entries_.size() >= kMostEntries &&
         entries_.begin()->first < (waiting_.empty() ? last_id_ + 1 : waiting_.front()))
    entries_.erase(entries_.begin());
}

void Robot::end(QueueState how, const std::string& message) {
  QueueEntry& entry = entries_.at(waiting_.front());
  entry.state = how;
  entry.message = message;
  waiting_.pop_front();
  events_.push_back("mission " + std::to_string(entry.id) + " " + name_of(how));
}

void Robot::abort_all() {
  while (!waiting_.empty()) end(QueueState::aborted, "Mission aborted");
}

bool Robot::abort(std::int64_t id) {
  const auto at = std::find(waiting_.begin(), waiting_.end(), id);
  if (at == waiting_.end()) return false;
  entries_.at(id).state = QueueState::aborted;
  entries_.at(id).message = "Mission aborted";
  waiting_.erase(at);
  events_.push_back("mission " + std::to_string(id) + " Aborted");
  return true;
}

void Robot::fail(RobotError error) {
  const bool stops = error.stops;
  events_.push_back("error " + std::to_string(error.code) + " " + error.description);
  errors_.push_back(std::move(error));
  if (stops && !waiting_.empty()) end(QueueState::aborted, errors_.back().description);
}

void Robot::clear_errors() {
  errors_.clear();
}

std::vector<std::string> Robot::take_events() {
  std::vector<std::string> out;
  out.swap(events_);
  return out;
}

}  // namespace trb::virtual_robots::mir
