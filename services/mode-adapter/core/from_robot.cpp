// What the modes tell of the robot: to whom it goes, and whose waiting it ends.
#include "services/mode-adapter/core/adapter_core.hpp"

namespace trb::adapter {

void ModeAdapterCore::settle(Now now, Outbox& out) {
  // By index: what an event leads to may add events of its own.
  for (std::size_t i = 0; i < robot_.events.size(); ++i) {
    const EventFrom from = std::move(robot_.events[i]);
    on_event(*from.mode, from.event, now, out);
  }
  robot_.events.clear();
  refresh_control(now);
  status_.publish(condition(), out);
}

void ModeAdapterCore::on_event(Driver& mode, const DriverEvent& event, Now now, Outbox& out) {
  std::visit(Overloaded{
                 [&](const HandedOver& handed) { on_progress(handed.token, "handed_over", now, out); },
                 [&](const Started& started) { on_progress(started.token, "started", now, out); },
                 [&](const Ended& ended) {
                   if (desk_.owns(ended.token)) desk_.on_ended(ended, now, out);
                 },
                 [&](const Refused& refused) { on_refused(refused, now, out); },
                 [&](const Said& said) { on_said(mode, said, now, out); },
                 [&](const FaultSaid& fault) { faults_.on_fault(fault, now, out); },
                 [&](const FaultOver& over) { faults_.on_over(over, now, out); },
                 [&](const ValuesHeard&) {
                   desk_.on_values(&mode, now, out);
                   streams_.on_values(mode, now, out);
                   watch_.on_values(mode, now, out);
                 },
                 [&](const Stopped& stopped) { stops_.on_stopped(&mode, stopped, out); },
                 [&](const Released& released) { stops_.on_released(&mode, released, out); },
                 [&](const LinkUp&) { on_link_up(mode, now, out); },
                 [&](const LinkDown& down) { on_link_down(mode, down.reason, now, out); },
             },
             event);
}

void ModeAdapterCore::on_progress(Token token, const char* state, Now now, Outbox& out) {
  if (desk_.owns(token)) return desk_.on_under_way(now);
  if (const auto request = commands_.take(token)) out.reply(*request, Ack{state, ""});
}

void ModeAdapterCore::on_refused(const Refused& refused, Now now, Outbox& out) {
  if (desk_.owns(refused.token)) return desk_.on_refused(refused.error, now, out);
  auto request = commands_.take(refused.token);
  if (!request) request = requests_.take(refused.token);
  if (!request) return;
  out.count("refused." + std::string(errc_name(refused.error.code)));
  out.nack(*request, refused.error);
}

void ModeAdapterCore::on_said(Driver& mode, const Said& said, Now now, Outbox& out) {
  Opaque body{said.subtype, said.data};
  if (said.type == MessageType::command) return out.command(said.target, std::move(body));
  if (said.type == MessageType::request) return out.request(said.target, std::move(body));
  if (said.target == robot_.settings.id) {
    desk_.on_information(&mode, said.subtype, said.data, now, out);
    watch_.on_field(said, now, out);
  }
  if (const auto request = requests_.take_answered(said.subtype, said.target)) {
    return out.reply(*request, std::move(body));
  }
  out.information(said.target, std::move(body));
}

void ModeAdapterCore::on_link_up(Driver& mode, Now now, Outbox& out) {
  out.count("from_robot.ready");
  if (&mode == &robot_.primary()) status_.on_up();
  stops_.on_link_up(mode, now, out);
}

void ModeAdapterCore::on_link_down(Driver& mode, const std::string& reason, Now now, Outbox& out) {
  if (&mode == &robot_.primary()) status_.on_down(reason);
  faults_.on_link_down();
  desk_.on_link_down(&mode, reason, now, out);
  streams_.on_link_down(mode);
  while (const auto request = requests_.take_any_of(&mode)) {
    out.nack(*request,
             fail(Errc::robot_offline, "the robot left before it answered: " + reason, "look at the robot's program"));
  }
}

}  // namespace trb::adapter
