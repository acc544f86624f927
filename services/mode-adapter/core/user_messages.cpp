#include "services/mode-adapter/core/user_messages.hpp"

#include <algorithm>

#include "common/fleet/did_you_mean.hpp"

namespace trb::adapter {
namespace {

constexpr std::size_t kMaxRequests = 64;
constexpr Duration kStale = std::chrono::seconds(2);

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// Robots' programs compare their words without case.
bool same_word(std::string_view one, std::string_view other) {
  return std::ranges::equal(one, other, {}, lower, lower);
}

Error too_many() {
  return fail(Errc::queue_full, "too many requests wait for the robot's answer", "ask less often");
}

}  // namespace

void UserMessages::on_message(const Inbound& message, const Opaque& body, Now now, Outbox& out) {
  if (message.type == MessageType::information) return on_information(message, body, now, out);
  if (message.remaining_ms == 0) {
    return out.nack(message, fail(Errc::expired, "its deadline had passed when it came to the robot's node"));
  }
  if (message.type == MessageType::command) return on_command(message, body, now, out);
  on_request(message, body, now, out);
}

void UserMessages::on_information(const Inbound& message, const Opaque& body, Now now, Outbox& out) {
  if (!means_command(body.subtype)) return inform(body.subtype, message.source, body.data, now, out);
  out.count("refused.not_as_command");
  out.log(LogLevel::warning, "not_as_command",
          "information '" + body.subtype + "' of " + message.source +
              " is not given to the robot: it has a command of that name; send it as a command");
}

/// A robot's program may carry out what it knows, whatever the type says: past lease, fence and out-of-use.
bool UserMessages::means_command(std::string_view subtype) const {
  const auto is_it = [&](const std::string& word) { return same_word(word, subtype); };
  const auto drives_by_it = [&](const Drive& drive) {
    return is_it(drive.command.subtype) || (drive.stand && is_it(drive.stand->subtype));
  };
  return std::ranges::any_of(robot_.settings.commands.commands, is_it,
                             [](const auto& command) -> const std::string& { return command.first; }) ||
         std::ranges::any_of(robot_.settings.description.skills, is_it, &Skill::subtype) ||
         std::ranges::any_of(robot_.settings.description.drives, drives_by_it);
}

void UserMessages::on_command(const Inbound& message, const Opaque& body, Now now, Outbox& out) {
  const Holder by{Holder::Kind::person, message.source};
  const bool take = (message.flags & kFlagTakeControl) != 0;
  Driver& mode = robot_.mode_for(MessageType::command, body.subtype);
  // Without a robot on the field channel the command cannot be carried out, whoever sends it: report that cause.
  const bool nobody_there = !robot_.is_native(mode) && !mode.online();
  if (const auto error = control_.barred(by, take || nobody_there, now)) {
    out.count("refused." + std::string(errc_name(error->code)));
    return out.nack(message, *error);
  }
  // An explicit takeover holds even if the command itself is refused: its sender wants the former holder silenced.
  if (take) control_.take(by, now, out);
  const auto token = wait_or_answer(commands_, message, body, mode, now, out);
  if (!token) return;
  control_.take(by, now, out);
  control_.began(mode, *token);
}

void UserMessages::on_request(const Inbound& message, const Opaque& body, Now now, Outbox& out) {
  Driver& mode = robot_.mode_for(MessageType::request, body.subtype);
  if (robot_.is_native(mode) && !begin_stream(message, body, mode, now, out)) return;
  if (mode.answers_from_values()) return answer_from_monitor(message, body, mode, now, out);
  if (requests_.size() >= kMaxRequests && !make_room(message, now, out)) return out.nack(message, too_many());
  wait_or_answer(requests_, message, body, mode, now, out);
}

/// Who asks too much keeps nobody else from asking. False: it is this sender.
bool UserMessages::make_room(const Inbound& message, Now now, Outbox& out) {
  const auto other = requests_.take_for(message.source);
  if (!other) return false;
  out.nack(other->second.message, too_many());
  other->second.mode->forget(other->first, now, robot_.to(*other->second.mode, out));
  return true;
}

/// A request with a stream is answered like any other; later values are information. False: refused.
bool UserMessages::begin_stream(const Inbound& message, const Opaque& body, Driver& mode, Now now, Outbox& out) {
  const auto order = read_stream_order(body.data);
  if (order && *order && !mode.online()) return true;  // its answer reports that
  const Status begun = !order   ? Status(order.error())
                       : *order ? streams_.add(body.subtype, message.source, mode, **order, now)
                                : Status(Done{});
  if (!begun) out.nack(message, begun.error());
  if (begun && *order && (*order)->for_s > 0) mode.watch(body.subtype, robot_.to(mode, out));
  return begun.ok();
}

std::optional<Token> UserMessages::wait_or_answer(WaitingSenders& waiting, const Inbound& message, const Opaque& body,
                                                  Driver& mode, Now now, Outbox& out) {
  const Token token = robot_.next_token();
  const auto progress = mode.hand_over(
      {token, message.type, body.subtype, message.source, body.data, {}, WaitingSenders::wait_s(message)}, now,
      robot_.to(mode, out));
  if (!progress) {
    out.count("refused." + std::string(errc_name(progress.error().code)));
    out.nack(message, explain(progress.error(), message.type, body.subtype));
    return std::nullopt;
  }
  if (*progress == Progress::handed_over) {
    out.reply(message, Ack{"handed_over", ""});
  } else {
    waiting.add(token, message, mode, now);
  }
  return token;
}

Error UserMessages::explain(const Error& error, MessageType type, std::string_view subtype) const {
  if (error.code != Errc::no_field_channel || robot_.settings.commands.transport == "lines") return error;
  const std::string word(subtype);
  const VendorCommands& words = robot_.settings.commands;
  const bool asks = type == MessageType::request;
  const std::vector<std::string> known = asks ? names_in(words.requests) : names_in(words.commands);
  const std::string add = "add '" + word + "' to \"" + (asks ? "requests" : "commands") + "\" of commands.json";
  std::string cure = known.empty() ? add : did_you_mean(word, known, add + ", or use one of");
  if (!cure.starts_with(add)) cure += " Else " + add;  // it may be no misspelling
  return fail(error.code,
              "commands.json has no words for '" + word + "' (" + robot_.settings.framework +
                  "), and the interpreter mode needs a robot connected to TCP_PORT: none is",
              cure + "; or start the robot's program that dials TCP_PORT");
}

void UserMessages::answer_from_monitor(const Inbound& message, const Opaque& body, Driver& mode, Now now, Outbox& out) {
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

void UserMessages::inform(std::string_view subtype, std::string_view source, BytesView data, Now now, Outbox& out) {
  Driver& mode = robot_.mode_for(MessageType::information, subtype);
  const Handover message{robot_.next_token(), MessageType::information, subtype, source, data, {}};
  const auto progress = mode.hand_over(message, now, robot_.to(mode, out));
  if (!progress) out.count("refused." + std::string(errc_name(progress.error().code)));
}

void UserMessages::on_nack(const Inbound& message, const Nack& nack, Now now, Outbox& out) {
  // Undelivered messages of the adapter itself are only counted; the robot gets back only its own.
  if (is_reserved(nack.subtype)) return out.count("refused.nack_" + nack.subtype);
  inform(Nack::kSubtype, message.source, nack.code + " " + nack.what, now, out);
}

void UserMessages::expire(WaitingSenders& waiting, const char* what, Now now, Outbox& out) {
  while (auto expired = waiting.take_expired(now)) {
    WaitingSender& sender = expired->second;
    out.nack(sender.message, fail(Errc::timeout, what, "look at the robot's program"));
    sender.mode->forget(expired->first, now, robot_.to(*sender.mode, out));
  }
}

void UserMessages::on_progress(Token token, const char* state, Outbox& out) {
  if (const auto request = commands_.take(token)) out.reply(*request, Ack{state, ""});
}

void UserMessages::on_refused(const Refused& refused, Outbox& out) {
  auto request = commands_.take(refused.token);
  if (!request) request = requests_.take(refused.token);
  if (!request) return;
  out.count("refused." + std::string(errc_name(refused.error.code)));
  out.nack(*request, refused.error);
}

void UserMessages::on_said(const Said& said, Outbox& out) {
  Opaque body{said.subtype, said.data};
  if (said.type == MessageType::command) return out.command(said.target, std::move(body));
  if (said.type == MessageType::request) return out.request(said.target, std::move(body));
  if (const auto request = requests_.take_answered(said.subtype, said.target)) {
    return out.reply(*request, std::move(body));
  }
  out.information(said.target, std::move(body));
}

void UserMessages::on_link_down(Driver& mode, const std::string& reason, Outbox& out) {
  streams_.on_link_down(mode);
  while (const auto request = requests_.take_any_of(&mode)) {
    out.nack(*request,
             fail(Errc::robot_offline, "the robot left before it answered: " + reason, "look at the robot's program"));
  }
}

void UserMessages::tick(Now now, Outbox& out) {
  expire(commands_, "the robot did not take it in time", now, out);
  expire(requests_, "the robot did not answer in time", now, out);
  for (const std::string& subtype : streams_.take_ended(now)) {
    robot_.primary().unwatch(subtype, robot_.to(robot_.primary(), out));
  }
}

std::optional<MonotonicTime> UserMessages::next_deadline() const {
  return earlier(streams_.next_deadline(), earlier(commands_.next_deadline(), requests_.next_deadline()));
}

}  // namespace trb::adapter
