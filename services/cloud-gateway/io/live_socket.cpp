#include "services/cloud-gateway/io/live_socket.hpp"

#include <algorithm>

#include "common/base/ids.hpp"
#include "services/cloud-gateway/io/api/call.hpp"
#include "services/cloud-gateway/io/drive_desk.hpp"
#include "services/cloud-gateway/io/drive_words.hpp"
#include "services/cloud-gateway/io/json_messages.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

constexpr int kMaxWrong = 20;
constexpr std::size_t kMaxDriveAnswers = 16;
constexpr std::uint16_t kPolicy = 1008;       // RFC 6455, 7.4.1
constexpr std::uint16_t kTryAgain = 1013;     // IANA's registry: Try Again Later
constexpr std::uint16_t kNotSignedIn = 4401;  // of our own: 4000 to 4999 are for applications

using SharedPart = std::shared_ptr<const Bytes>;

SharedPart part(std::string text) {
  return std::make_shared<const Bytes>(std::move(text));
}

/// The encoded block, made once for all its clients.
SharedPart joined(const Block& block) {
  if (block.joined != nullptr) return block.joined;
  JsonList rows;
  for (const SharedBytes& row : block.rows) rows.add(*row);
  JsonObject out;
  out.text("topic", text_of(block.topic)).flag("begins", block.begins).flag("snapshot", block.is_snapshot);
  out.flag("more", block.more).number("to", block.to).raw("rows", rows.done());
  block.joined = part(out.done());
  return block.joined;
}

std::string json_notices(const std::vector<Notice>& notices) {
  JsonList out;
  for (const Notice& one : notices) {
    out.add(JsonObject().text("topic", text_of(one.topic)).text("kind", name_of(one.kind)).done());
  }
  return out.done();
}

/// {"count": ..., "blocks": [ and what follows it; the blocks themselves are shared with other clients.
std::vector<SharedPart> parts_of(const Frame& frame, const Gateway& gateway) {
  JsonObject head;
  head.number("count", frame.count).number("head", frame.head).number("instance", gateway.clients.instance());
  head.time("time", frame.time);
  if (!frame.silent.empty()) head.raw("silent", json_silent(frame.silent));
  if (!frame.messages.empty()) head.raw("phases", json_phases(gateway.messages.counts()));
  head.raw("notices", json_notices(frame.notices)).number("left_out", frame.left_out);
  JsonList messages;
  for (const SharedBytes& one : frame.messages) messages.add(*one);
  std::string begin = head.raw("messages", messages.done()).done();
  begin.pop_back();
  std::vector<SharedPart> out{part(begin + ",\"blocks\":[")};
  for (const SharedBlock& block : frame.blocks) {
    if (out.size() > 1) out.push_back(part(","));
    out.push_back(joined(*block));
  }
  out.push_back(part("]}"));
  return out;
}

}  // namespace

Result<std::shared_ptr<LiveSocket>> LiveSocket::open(Gateway& gateway, HttpRequest request, std::string who) {
  const auto of_who = std::ranges::count_if(
      gateway.sockets, [&](const auto& one) { return one.second->who_ == who && !one.second->is_ending_; });
  if (static_cast<std::size_t>(of_who) >= kMostOfOne) {
    return fail(Errc::queue_full, "live: '" + who + "' has " + std::to_string(kMostOfOne) + " live streams",
                "close one; a program needs one alone");
  }
  const auto client = gateway.clients.open();
  if (!client) return client.error();
  return std::shared_ptr<LiveSocket>(new LiveSocket(gateway, std::move(request), std::move(who), *client));
}

LiveSocket::LiveSocket(Gateway& gateway, HttpRequest request, std::string who, ClientId client)
    : gateway_(gateway), request_(std::move(request)), who_(std::move(who)), client_(client) {
  gateway_.sockets[client_] = this;
}

LiveSocket::~LiveSocket() {
  gateway_.sockets.erase(client_);
  gateway_.clients.close(client_);
  gateway_.drives->leave(client_);
}

void LiveSocket::on_open(std::shared_ptr<WebSocketOut> out) {
  out_ = std::move(out);
  pump();
}

void LiveSocket::on_message(BytesView text) {
  const auto word = read_live_word(text);
  const Status obeyed = word ? std::visit([this](const auto& one) { return obey(one); }, *word) : Status(word.error());
  if (!obeyed) refuse(obeyed.error());
}

Status LiveSocket::obey(const Subscribe& word) {
  return gateway_.clients.subscribe(client_, word.topic, word.resume);
}

Status LiveSocket::obey(const Unsubscribe& word) {
  gateway_.clients.unsubscribe(client_, word.topic);
  return Done{};
}

Status LiveSocket::obey(const DriveWord& word) {
  const auto who = driver();
  return who ? gateway_.drives->drive(*who, word) : Status(who.error());
}

Status LiveSocket::obey(const AskFor& word) {
  const auto who = driver();
  return who ? gateway_.drives->ask(*who, word.robot) : Status(who.error());
}

Status LiveSocket::obey(const LetGo& word) {
  const auto who = driver();
  if (!who) return who.error();
  gateway_.drives->let_go(client_, word.robot);
  return Done{};
}

/// Looked at for each word: who is signed out, or is a viewer from now on, drives no further.
Result<Driver> LiveSocket::driver() {
  const RequestDecision decision = gateway_.access.check.check(request_.head(), gateway_.steady());
  const bool may = decision.verdict == RequestVerdict::allowed && !decision.who.read_only &&
                   suffices(decision.who.role, Least::operator_);
  if (may) return Driver{client_, cut_utf8(decision.who.name, kMaxIdSize), request_.source};
  gateway_.drives->leave(client_);
  return fail(Errc::not_permitted, "drive: you may not drive a robot",
              "sign in as an operator, or use a token that may change something");
}

void LiveSocket::send_drive(const DriveAnswer& answer) {
  if (is_ending_) return;
  // Why a drive is over is told, whatever is refused after it.
  const auto at = drive_answers_.find(answer.robot);
  if (at != drive_answers_.end() && at->second.is_over && answer.is_over) return;
  if (at == drive_answers_.end() && drive_answers_.size() == kMaxDriveAnswers) drive_answers_.clear();
  drive_answers_[answer.robot] = {answer.is_over, json_drive_answer(answer)};
  pump();
}

void LiveSocket::refuse(const Error& error) {
  if (++wrong_ > kMaxWrong && out_ != nullptr) return end(kPolicy, "too many wrong words");
  problem_ = "{\"error\":" + *problem_reply(error).body + "}";
  pump();
}

void LiveSocket::send(Bytes text) {
  sending_ = true;
  out_->send({part(std::move(text))});
}

void LiveSocket::pump() {
  if (out_ == nullptr || sending_) return;
  if (!problem_.empty()) return send(std::exchange(problem_, {}));
  if (!drive_answers_.empty()) return send(std::move(drive_answers_.extract(drive_answers_.begin()).mapped().text));
  const auto frame = gateway_.clients.take(client_);
  if (!frame) return;
  sending_ = true;
  ++gateway_.counts.frames;
  out_->send(parts_of(*frame, gateway_));
}

void LiveSocket::on_sent() {
  sending_ = false;
  pump();
}

void LiveSocket::on_closed() {
  out_ = nullptr;
  gateway_.clients.close(client_);
  gateway_.drives->leave(client_);
}

void LiveSocket::check_rights() {
  const RequestDecision decision = gateway_.access.check.check(request_.head(), gateway_.steady());
  if (decision.verdict != RequestVerdict::allowed && out_ != nullptr) end(kNotSignedIn, "signed out");
}

void LiveSocket::end_without_database() {
  if (out_ != nullptr) end(kTryAgain, "no database");
}

/// Its topics and its drive end now, also if the client never answers the close.
void LiveSocket::end(std::uint16_t code, const std::string& reason) {
  is_ending_ = true;
  gateway_.clients.close(client_);
  gateway_.drives->leave(client_);
  out_->close(code, reason);
}

}  // namespace trb::gateway
