#include "services/mode-adapter/core/robot_status.hpp"

#include "common/tls/tls_trust.hpp"

namespace trb::adapter {
namespace {

constexpr std::size_t kMaxDetail = 255;

}  // namespace

RobotStatus::RobotStatus(const Settings& settings) : settings_(settings) {
  const Description& description = settings.description;
  profile_.framework = settings.framework;
  profile_.mode = std::string(name_of(settings.mode));
  profile_.transport = settings.commands.transport;
  profile_.maker = description.maker;
  profile_.model = description.model;
  profile_.capabilities = description.capabilities;
  profile_.sensors = description.sensors;
  profile_.skills = skill_infos(description);
  profile_.numbers = description.numbers;
  for (const Drive& drive : description.drives) profile_.drives.push_back(drive.info());
  for (const Skill& skill : description.skills) skills_.push_back({skill.name, skill.capability, skill.repeatable});
  profile_.places = place_names(description, settings.places);
  const RobotFrame& frame = description.frame;
  profile_.frame = {frame.length, frame.origin.x, frame.origin.y, frame.origin.yaw};
}

void RobotStatus::on_up() {
  connection_ = Connection::online;
  detail_.clear();
}

void RobotStatus::on_down(const std::string& reason) {
  const std::string detail = reason.substr(0, kMaxDetail);
  detail_changed_ = detail_changed_ || (connection_ == Connection::broken && detail != detail_);
  connection_ = Connection::broken;
  detail_ = detail;
}

void RobotStatus::on_no_contact(const std::string& reason) {
  const std::string detail = reason.substr(0, kMaxDetail);
  // That a robot which was there has another certificate now is worth more than how it went.
  const bool other_robot = connection_ == Connection::broken && reason.find(kTlsFailed) != std::string::npos;
  if ((connection_ != Connection::offline && !other_robot) || detail_ == detail) return;
  detail_ = detail;
  detail_changed_ = true;
}

std::string RobotStatus::connection_name() const {
  if (connection_ == Connection::online) return "ONLINE";
  return connection_ == Connection::broken ? "CONNECTION_BROKEN" : "OFFLINE";
}

AdapterState RobotStatus::state(const Condition& condition) const {
  return {settings_.instance,
          connection_name(),
          condition.fenced,
          condition.busy,
          condition.for_runs ? "" : condition.control,
          condition.out_of_use,
          skills_};
}

void RobotStatus::welcome(const Condition& condition, Outbox& out) {
  welcomed_ = true;
  told_ = {connection_, condition};
  had_contact_ = had_contact_ || connection_ == Connection::online;
  out.information(settings_.id, state(condition));
  send_profile(condition, out);
}

void RobotStatus::publish(const Condition& condition, Outbox& out) {
  const Told now{connection_, condition};
  if (!welcomed_ || (now == told_ && !detail_changed_)) return;
  const Told before = std::exchange(told_, now);
  if (now != before) out.information(settings_.id, state(condition));
  const bool shown = now.connection != before.connection || condition.fenced != before.condition.fenced ||
                     condition.control != before.condition.control ||
                     condition.out_of_use != before.condition.out_of_use;
  if (shown || detail_changed_) send_profile(condition, out);
  if (now.connection != before.connection && had_contact_) {
    out.information(std::string(kEveryNode), RobotConnection{connection_name(), detail_});
  }
  had_contact_ = had_contact_ || connection_ == Connection::online;
}

void RobotStatus::repeat(const Condition& condition, Outbox& out) const {
  if (welcomed_) out.information(settings_.id, state(condition));
}

void RobotStatus::send_profile(const Condition& condition, Outbox& out) {
  detail_changed_ = false;
  NodeProfile profile = profile_;
  profile.robot = connection_name();
  profile.detail = detail_;
  profile.fenced = condition.fenced;
  profile.control = condition.control;
  profile.out_of_use = condition.out_of_use;
  out.information(settings_.id, std::move(profile));
}

}  // namespace trb::adapter
