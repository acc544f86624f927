#include "services/mode-adapter/core/adapter_core.hpp"

namespace trb::adapter {

ModeAdapterCore::ModeAdapterCore(Settings settings, PersistFence persist, PersistOutOfUse keep, InjectLine inject)
    : robot_(std::move(settings)),
      status_(robot_.settings),
      stops_(robot_, std::move(persist)),
      desk_(robot_),
      faults_(robot_, desk_, std::move(keep)),
      watch_(robot_.settings, faults_),
      injection_(robot_.settings, std::move(inject)) {}

void ModeAdapterCore::on_welcome(const NodeIdentity&, Now, Outbox& out) {
  status_.welcome(condition(), out);
}

void ModeAdapterCore::on(const Inbound& message, Now now, Outbox& out) {
  const bool taken = Taken::dispatch(
      message.body, Overloaded{
                        [&](const Execute& order) { execute(message, order, now, out); },
                        [&](const CancelExecution& order) { desk_.cancel(message, order, now, out); },
                        [&](const ExecutionQuery& query) { desk_.query(message, query, out); },
                        [&](const OutcomeJournaled& outcome) { desk_.journaled(outcome); },
                        [&](const AdapterStateRequest&) { out.reply(message, status_.state(condition())); },
                        [&](const Stop& stop) {
                          desk_.interrupt("stopped by " + message.source + ": " + stop.reason, now, out);
                          stops_.on_stop(message, now, out);
                        },
                        [&](const Release&) { stops_.on_release(message, now, out); },
                        [&](const TakeOutOfUse& order) { faults_.on_take_out(message, order, now, out); },
                        [&](const TakeIntoUse& order) { faults_.on_take_in(message, order, out); },
                        [&](const InjectFault& order) { injection_.on_inject(message, order, out); },
                        [&](const BridgeEvent& event) { on_bridge(message, event, now, out); },
                        [&](const BridgeState& state) {
                          on_bridge(message, state, now, out);
                          if (!state.up && message.source == robot_.settings.id) status_.on_no_contact(state.detail);
                        },
                    });
  if (!taken) on_other(message, now, out);
  settle(now, out);
}

/// A user's own word, or an answer.
void ModeAdapterCore::on_other(const Inbound& message, Now now, Outbox& out) {
  visit(Overloaded{[&](const Opaque& body) { on_opaque(message, body, now, out); },
                   [&](const Nack& nack) { on_nack(message, nack, now, out); }, [&](const Ack&) {},
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
  // Before the modes: a stop's answer says what was known at its deadline.
  stops_.tick(now, out);
  faults_.save(now, out);
  robot_.for_each([&](Driver& mode) { mode.tick(now, robot_.to(mode, out)); });
  settle(now, out);
  desk_.tick(now, out);
  watch_.tick(now, out);
  expire(commands_, "the robot did not take it in time", now, out);
  expire(requests_, "the robot did not answer in time", now, out);
  end_streams(now, out);
  settle(now, out);
}

std::optional<MonotonicTime> ModeAdapterCore::next_deadline() const {
  const auto watched = watch_.next_deadline();
  const auto pending = earlier(control_.next_deadline(), earlier(commands_.next_deadline(), requests_.next_deadline()));
  const auto kept = earlier(stops_.next_deadline(), streams_.next_deadline());
  return earlier(earlier(kept, desk_.next_deadline()), earlier(robot_.next_deadline(), earlier(pending, watched)));
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

void ModeAdapterCore::leave(Now now, Outbox& out) {
  robot_.for_each([&](Driver& mode) { mode.leave(now, robot_.to(mode, out)); });
}

void ModeAdapterCore::on_bytes(Channel channel, BytesView bytes, Now now, Outbox& out) {
  robot_.for_each([&](Driver& mode) { mode.on_bytes(channel, bytes, now, robot_.to(mode, out)); });
  settle(now, out);
}

}  // namespace trb::adapter
