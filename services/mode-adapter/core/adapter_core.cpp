#include "services/mode-adapter/core/adapter_core.hpp"

namespace trb::adapter {

ModeAdapterCore::ModeAdapterCore(Settings settings, PersistFence persist, PersistOutOfUse keep, InjectLine inject)
    : robot_(std::move(settings)),
      status_(robot_.settings),
      stops_(robot_, std::move(persist)),
      desk_(robot_),
      faults_(robot_, desk_, std::move(keep)),
      watch_(robot_.settings, faults_),
      injection_(robot_.settings, std::move(inject)),
      control_(stops_, robot_.settings.id),
      hand_(robot_, control_, faults_, desk_),
      messages_(robot_, control_) {}

void ModeAdapterCore::on_welcome(const NodeIdentity&, Now now, Outbox& out) {
  welcomed_ = now.mono;
  status_.welcome(condition(), out);
}

bool ModeAdapterCore::begins_something(const Inbound& message) {
  const bool users = message.type == MessageType::command && holds_alternative<Opaque>(message.body);
  return users || holds_alternative<Execute>(message.body) || holds_alternative<Velocity>(message.body);
}

void ModeAdapterCore::on(const Inbound& message, Now now, Outbox& out) {
  if (leaving_ && begins_something(message)) {
    return out.nack(message, fail(Errc::robot_offline, "the robot's mode-adapter ends", "send it again later"));
  }
  const bool taken = Taken::dispatch(
      message.body, Overloaded{
                        [&](const Execute& order) { execute(message, order, now, out); },
                        [&](const CancelExecution& order) { desk_.cancel(message, order, stops_.fenced(), now, out); },
                        [&](const ExecutionQuery& query) {
                          if (!desk_.query(message, query, out) && to_be_replaced_)
                            expects_until_ = now.mono + kGivenAgain;
                        },
                        [&](const OutcomeJournaled& outcome) { desk_.journaled(outcome); },
                        [&](const AdapterStateRequest&) { out.reply(message, status_.state(condition())); },
                        [&](const Stop& stop) {
                          const std::string by = "stopped by " + message.source + ": " + stop.reason;
                          desk_.interrupt(by, now, out);
                          hand_.on_stop(by, out);
                          stops_.on_stop(message, now, out);
                        },
                        [&](const Release&) { stops_.on_release(message, now, out); },
                        [&](const TakeOutOfUse& order) { faults_.on_take_out(message, order, now, out); },
                        [&](const TakeIntoUse& order) { faults_.on_take_in(message, order, out); },
                        [&](const InjectFault& order) { injection_.on_inject(message, order, out); },
                        [&](const Velocity& velocity) { hand_.on_velocity(message, velocity, now, out); },
                        [&](const BridgeEvent& event) { on_bridge(message, event, now, out); },
                        [&](const BridgeState& state) {
                          on_bridge(message, state, now, out);
                          if (!state.up && message.source == robot_.settings.id) status_.on_no_contact(state.detail);
                        },
                    });
  if (!taken) on_other(message, now, out);
  settle(now, out);
}

/// A user's own message, or an answer.
void ModeAdapterCore::on_other(const Inbound& message, Now now, Outbox& out) {
  visit(Overloaded{[&](const Opaque& body) {
                     if (const auto driven = hand_.on_command(message, now, out)) {
                       out.count("refused." + std::string(errc_name(driven->code)));
                       return out.nack(message, *driven);
                     }
                     messages_.on_message(message, body, now, out);
                   },
                   [&](const Nack& nack) { messages_.on_nack(message, nack, now, out); }, [&](const Ack&) {},
                   [&](const auto&) {
                     out.count("refused.unexpected");
                     out.nack(message, fail(Errc::unknown_subtype, "the mode-adapter takes no such message"));
                   }},
        message.body);
}

template <class Heard>
void ModeAdapterCore::on_bridge(const Inbound& message, const Heard& heard, Now now, Outbox& out) {
  if (message.source != robot_.settings.id) return out.count("refused.not_permitted");
  robot_.primary().on_bridge(heard, now, robot_.to(robot_.primary(), out));
}

void ModeAdapterCore::tick(Now now, Outbox& out) {
  // Before the modes: a stop's answer shows what was known at its deadline.
  stops_.tick(now, out);
  faults_.save(now, out);
  hand_.tick(now, out);
  robot_.for_each([&](Driver& mode) { mode.tick(now, robot_.to(mode, out)); });
  settle(now, out);
  desk_.tick(now, out);
  watch_.tick(now, out);
  messages_.tick(now, out);
  settle(now, out);
}

std::optional<MonotonicTime> ModeAdapterCore::next_deadline() const {
  const auto commanded = earlier(earlier(control_.next_deadline(), hand_.next_deadline()), messages_.next_deadline());
  const auto robot = earlier(robot_.next_deadline(), watch_.next_deadline());
  return earlier(earlier(stops_.next_deadline(), desk_.next_deadline()), earlier(commanded, robot));
}

void ModeAdapterCore::on_channel_up(Channel channel, Now now, Outbox& out) {
  robot_.for_each([&](Driver& mode) { mode.on_up(channel, now, robot_.to(mode, out)); });
  settle(now, out);
}

void ModeAdapterCore::on_channel_down(Channel channel, const std::string& reason, Now now, Outbox& out) {
  const bool was_online = robot_.primary().online();
  robot_.for_each([&](Driver& mode) { mode.on_down(channel, reason, now, robot_.to(mode, out)); });
  const bool own_channel = (channel == Channel::field) != robot_.is_native(robot_.primary());
  if (!was_online && own_channel) status_.on_no_contact(std::string(name_of(channel)) + ": " + reason);
  settle(now, out);
}

bool ModeAdapterCore::at_work(Now now) const {
  return desk_.busy() || hand_.driving() || desk_.owes_outcome(now) || expects_until_;
}

bool ModeAdapterCore::may_be_replaced(MonotonicTime heard, Now now, Outbox& out) {
  to_be_replaced_ = true;
  if (expects_until_ && now.mono >= *expects_until_) expects_until_.reset();
  settle(now, out);
  if (at_work(now)) return false;
  if (!quiet_since_) quiet_since_ = now.mono;
  // A router that is not heard may be about to be started anew, with an order that it will not deliver.
  const bool is_heard = heard - *quiet_since_ >= kQuiet && heard - welcomed_ >= kGivenAgain;
  return is_heard || now.mono - *quiet_since_ >= kNoRouter;
}

void ModeAdapterCore::begin_leave(Now now, Outbox& out) {
  leaving_ = true;
  hand_.give_way("the robot's node ends", now, out);
  settle(now, out);
}

void ModeAdapterCore::leave(Now now, Outbox& out) {
  hand_.give_way("the robot's node ends", now, out);
  robot_.for_each([&](Driver& mode) { mode.leave(now, robot_.to(mode, out)); });
}

void ModeAdapterCore::on_bytes(Channel channel, BytesView bytes, Now now, Outbox& out) {
  robot_.for_each([&](Driver& mode) { mode.on_bytes(channel, bytes, now, robot_.to(mode, out)); });
  settle(now, out);
}

void ModeAdapterCore::execute(const Inbound& message, const Execute& order, Now now, Outbox& out) {
  const Holder by{Holder::Kind::run, order.key.run};
  auto error = control_.barred(by, false, now);
  if (!error) error = faults_.refusal(order);
  if (error && (error->code == Errc::control_held || error->code == Errc::out_of_use)) {
    out.count("refused." + std::string(errc_name(error->code)));
  }
  if (!desk_.execute(message, order, error, now, out)) return;
  expects_until_.reset();
  control_.take(by, now, out);
}

Condition ModeAdapterCore::condition() const {
  const auto& holder = control_.holder();
  const bool busy = desk_.busy() || (to_be_replaced_ && !expects_until_);
  if (!holder) return {stops_.fenced(), busy, {}, true, faults_.shown()};
  return {stops_.fenced(), busy, holder->text(), holder->kind == Holder::Kind::run, faults_.shown()};
}

void ModeAdapterCore::settle(Now now, Outbox& out) {
  // An event may cause further events.
  const auto handle_events = [&] {
    while (const auto from = robot_.next_event()) on_event(*from->mode, from->event, now, out);
  };
  handle_events();
  hand_.look_at_faults(now, out);
  handle_events();
  control_.refresh(desk_.busy(), hand_.driving(), now);
  const bool told = desk_.take_told();
  status_.publish(condition(), out);
  if (!to_be_replaced_) return;
  if (told) status_.repeat(condition(), out);
  if (at_work(now)) quiet_since_.reset();
}

void ModeAdapterCore::on_event(Driver& mode, const DriverEvent& event, Now now, Outbox& out) {
  std::visit(Overloaded{
                 [&](const HandedOver& handed) { on_progress(handed.token, "handed_over", now, out); },
                 [&](const Started& started) { on_progress(started.token, "started", now, out); },
                 [&](const Ended& ended) {
                   if (desk_.owns(ended.token)) desk_.on_ended(ended, now, out);
                 },
                 [&](const Halted& halted) { desk_.on_halted(halted, now, out); },
                 [&](const Refused& refused) {
                   if (desk_.owns(refused.token)) return desk_.on_refused(refused.error, now, out);
                   if (hand_.owns(refused.token)) return hand_.on_refused(refused, now, out);
                   messages_.on_refused(refused, out);
                 },
                 [&](const Said& said) { on_said(mode, said, now, out); },
                 [&](const FaultSaid& fault) { faults_.on_fault(fault, now, out); },
                 [&](const FaultOver& over) { faults_.on_over(over, now, out); },
                 [&](const ValuesHeard&) { on_values(mode, now, out); },
                 [&](const Stopped& stopped) {
                   desk_.on_stopped(&mode);
                   hand_.on_stopped(mode);
                   stops_.on_stopped(&mode, stopped, out);
                 },
                 [&](const NotStopped& refused) { stops_.on_not_stopped(&mode, refused, out); },
                 [&](const Released& released) {
                   hand_.on_stopped(mode);
                   stops_.on_released(&mode, released, out);
                 },
                 [&](const LinkUp&) { on_link_up(mode, now, out); },
                 [&](const LinkDown& down) { on_link_down(mode, down.reason, now, out); },
             },
             event);
}

void ModeAdapterCore::on_progress(Token token, const char* state, Now now, Outbox& out) {
  if (desk_.owns(token)) return desk_.on_under_way(now);
  if (hand_.owns(token)) return hand_.on_under_way(token, now, out);
  messages_.on_progress(token, state, out);
}

void ModeAdapterCore::on_said(Driver& mode, const Said& said, Now now, Outbox& out) {
  const bool asks = said.type == MessageType::command || said.type == MessageType::request;
  if (!asks && said.target == robot_.settings.id) {
    desk_.on_information(&mode, said.subtype, said.data, now, out);
    watch_.on_field(said, now, out);
  }
  messages_.on_said(said, out);
}

void ModeAdapterCore::on_values(Driver& mode, Now now, Outbox& out) {
  desk_.on_values(&mode, now, out);
  messages_.on_values(mode, now, out);
  watch_.on_values(mode, now, out);
}

void ModeAdapterCore::on_link_up(Driver& mode, Now now, Outbox& out) {
  out.count("from_robot.ready");
  if (&mode == &robot_.primary()) status_.on_up();
  stops_.on_link_up(mode, now, out);
  desk_.on_link_up(mode, stops_.fenced(), now, out);
  hand_.on_link_up(mode, now, out);
}

void ModeAdapterCore::on_link_down(Driver& mode, const std::string& reason, Now now, Outbox& out) {
  if (&mode == &robot_.primary()) status_.on_down(reason);
  faults_.on_link_down();
  desk_.on_link_down(&mode, reason, now, out);
  hand_.on_link_down(mode, reason, out);
  messages_.on_link_down(mode, reason, out);
}

}  // namespace trb::adapter
