// Messages for the robot: which mode takes them, and what their sender is answered.
#include <algorithm>

#include "services/mode-adapter/core/adapter_core.hpp"

namespace trb::adapter {
namespace {

constexpr std::size_t kMaxRequests = 64;
constexpr Duration kStale = std::chrono::seconds(2);

}  // namespace

void ModeAdapterCore::on_opaque(const Inbound& message, const Opaque& body, Now now, Outbox& out) {
  if (message.type == MessageType::information) return inform(body.subtype, message.source, body.data, now, out);
  if (message.remaining_ms == 0) {
    return out.nack(message, fail(Errc::expired, "its deadline had passed when it came to the robot's node"));
  }
  if (message.type == MessageType::command) return on_command(message, body, now, out);
  on_request(message, body, now, out);
}

void ModeAdapterCore::on_command(const Inbound& message, const Opaque& body, Now now, Outbox& out) {
  const Holder by{Holder::Kind::person, message.source};
  const bool take = (message.flags & kFlagTakeControl) != 0;
  Driver& mode = robot_.mode_for(MessageType::command, body.subtype);
  // With no robot on the field channel the command goes nowhere, whoever gives it: that is the cause to be told.
  const bool nobody_there = !robot_.is_native(mode) && !mode.online();
  if (const auto error = barred(by, take || nobody_there, now)) {
    out.count("refused." + std::string(errc_name(error->code)));
    return out.nack(message, *error);
  }
  // By word it is taken over even if the command itself is refused: whoever asks for it wants the former one silent.
  if (take) take_control(by, now, out);
  const auto token = wait_or_answer(commands_, message, body, mode, now, out);
  if (!token) return;
  take_control(by, now, out);
  commanded_ = {&mode, *token};
}

void ModeAdapterCore::on_request(const Inbound& message, const Opaque& body, Now now, Outbox& out) {
  Driver& mode = robot_.mode_for(MessageType::request, body.subtype);
  if (robot_.is_native(mode) && !begin_stream(message, body, mode, now, out)) return;
  if (mode.answers_from_values()) return answer_from_monitor(message, body, mode, now, out);
  if (requests_.size() >= kMaxRequests) {
    return out.nack(message, fail(Errc::queue_full, "too many requests wait for the robot's answer", "ask less often"));
  }
  wait_or_answer(requests_, message, body, mode, now, out);
}

/// A request that asks for a stream is answered like any other; what comes later is information. False: refused.
bool ModeAdapterCore::begin_stream(const Inbound& message, const Opaque& body, Driver& mode, Now now, Outbox& out) {
  const auto order = read_stream_order(body.data);
  if (order && *order && !mode.online()) return true;  // its answer says so
  const Status begun = !order   ? Status(order.error())
                       : *order ? streams_.add(body.subtype, message.source, mode, **order, now)
                                : Status(Done{});
  if (!begun) out.nack(message, begun.error());
  if (begun && *order && (*order)->for_s > 0) mode.watch(body.subtype, robot_.to(mode, out));
  return begun.ok();
}

void ModeAdapterCore::end_streams(Now now, Outbox& out) {
  for (const std::string& subtype : streams_.take_ended(now)) {
    robot_.primary().unwatch(subtype, robot_.to(robot_.primary(), out));
  }
}

std::optional<Token> ModeAdapterCore::wait_or_answer(PendingRequests& pending, const Inbound& message,
                                                     const Opaque& body, Driver& mode, Now now, Outbox& out) {
  const Token token = robot_.next_token();
  const auto progress =
      mode.hand_over({token, message.type, body.subtype, message.source, body.data, {}}, now, robot_.to(mode, out));
  if (!progress) {
    out.count("refused." + std::string(errc_name(progress.error().code)));
    out.nack(message, explain(progress.error(), body.subtype));
    return std::nullopt;
  }
  if (*progress == Progress::handed_over) {
    out.reply(message, Ack{"handed_over", ""});
  } else {
    pending.add(token, message, mode, now);
  }
  return token;
}

Error ModeAdapterCore::explain(const Error& error, std::string_view subtype) const {
  if (error.code != Errc::no_field_channel || robot_.settings.commands.transport == "lines") return error;
  const std::string word(subtype);
  return fail(error.code,
              "commands.json has no words for '" + word + "' (" + robot_.settings.framework +
                  "), and the interpreter mode needs a robot connected to TCP_PORT: none is",
              "add '" + word + "' to commands.json, or start the robot's program that dials TCP_PORT");
}

void ModeAdapterCore::answer_from_monitor(const Inbound& message, const Opaque& body, Driver& mode, Now now,
                                          Outbox& out) {
  const RobotValue* value = mode.value(body.subtype);
  if (value != nullptr && now.mono - value->heard <= kStale) {
    return out.reply(message, Opaque{body.subtype, value->json});
  }
  if (!mode.online()) {
    return out.nack(message, fail(Errc::robot_offline, "the robot's controller is not connected",
                                  "look at its power, network and address"));
  }
  if (const auto problem = mode.problem(body.subtype)) return out.nack(message, *problem);
  out.nack(message, fail(Errc::timeout, "the robot's monitor has not told '" + body.subtype + "' for 2 s",
                         "look whether commands.json maps it to a value that the monitor reports"));
}

void ModeAdapterCore::inform(std::string_view subtype, std::string_view source, BytesView data, Now now, Outbox& out) {
  Driver& mode = robot_.mode_for(MessageType::information, subtype);
  const Handover message{robot_.next_token(), MessageType::information, subtype, source, data, {}};
  const auto progress = mode.hand_over(message, now, robot_.to(mode, out));
  if (!progress) out.count("refused." + std::string(errc_name(progress.error().code)));
}

void ModeAdapterCore::on_nack(const Inbound& message, const Nack& nack, Now now, Outbox& out) {
  // What the adapter itself has sent in vain is counted, only the robot's own words come back to the robot.
  if (is_typed(nack.subtype)) return out.count("refused.nack_" + nack.subtype);
  inform(Nack::kSubtype, message.source, nack.code + " " + nack.what, now, out);
}

void ModeAdapterCore::expire(PendingRequests& pending, const char* what, Now now, Outbox& out) {
  while (auto expired = pending.take_expired(now)) {
    PendingRequest& request = expired->second;
    out.nack(request.message, fail(Errc::timeout, what, "look at the robot's program"));
    request.mode->forget(expired->first, now, robot_.to(*request.mode, out));
  }
}

}  // namespace trb::adapter
