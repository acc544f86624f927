#include "services/mode-adapter/core/robot_status.hpp"

namespace trb::adapter {
namespace {

constexpr std::size_t kMaxDetail = 255;

}  // namespace

RobotStatus::RobotStatus(const Settings& settings) : settings_(settings) {
  const Description& description = settings.description;
  profile_.framework = settings.framework;
  profile_.mode = std::string(name_of(settings.mode));
  profile_.transport = settings.mode == Mode::direct ? settings.commands.transport : "lines";
  profile_.maker = description.maker;
  profile_.model = description.model;
  profile_.capabilities = description.capabilities;
  profile_.skills = skill_infos(description);
  profile_.places = place_names(description, settings.places);
}

void RobotStatus::on_up() {
  connection_ = Connection::online;
  detail_.clear();
}

void RobotStatus::on_down(const std::string& reason) {
  connection_ = Connection::broken;
  detail_ = reason.substr(0, kMaxDetail);
}

void RobotStatus::on_no_contact(const std::string& reason) {
  if (connection_ != Connection::offline || detail_ == reason) return;
  detail_ = reason.substr(0, kMaxDetail);
  detail_changed_ = true;
}

std::string RobotStatus::connection_name() const {
  if (connection_ == Connection::online) return "ONLINE";
  return connection_ == Connection::broken ? "CONNECTION_BROKEN" : "OFFLINE";
}

AdapterState RobotStatus::state(bool fenced, bool busy) const {
  return {settings_.instance, connection_name(), fenced, busy};
}

void RobotStatus::welcome(bool fenced, bool busy, Outbox& out) {
  welcomed_ = true;
  told_ = {connection_, fenced, busy};
  had_contact_ = had_contact_ || connection_ == Connection::online;
  out.information(settings_.id, state(fenced, busy));
  tell_profile(fenced, out);
}

void RobotStatus::publish(bool fenced, bool busy, Outbox& out) {
  const Told now{connection_, fenced, busy};
  if (!welcomed_ || (now == told_ && !detail_changed_)) return;
  const Told before = std::exchange(told_, now);
  if (now != before) out.information(settings_.id, state(fenced, busy));
  if (now.connection != before.connection || now.fenced != before.fenced || detail_changed_) tell_profile(fenced, out);
  if (now.connection != before.connection && had_contact_) {
    out.information(std::string(kEveryNode), RobotConnection{connection_name(), detail_});
  }
  had_contact_ = had_contact_ || connection_ == Connection::online;
}

void RobotStatus::tell_profile(bool fenced, Outbox& out) {
  detail_changed_ = false;
  NodeProfile profile = profile_;
  profile.robot = connection_name();
  profile.detail = detail_;
  profile.fenced = fenced;
  out.information(settings_.id, std::move(profile));
}

}  // namespace trb::adapter
