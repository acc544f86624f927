#include "services/cloud-gateway/io/live_socket.hpp"

#include "services/cloud-gateway/io/api/call.hpp"
#include "services/cloud-gateway/io/json_messages.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

constexpr int kMaxWrong = 20;
constexpr std::uint16_t kPolicy = 1008;       // RFC 6455, 7.4.1
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

std::optional<Resume> resume_of(const Value& word) {
  const Value* instance = word.find("instance");
  const Value* from = word.find("from");
  if (instance == nullptr || from == nullptr || !instance->is_integer() || !from->is_integer()) return std::nullopt;
  return Resume{static_cast<std::uint64_t>(instance->integer()), static_cast<std::uint64_t>(from->integer())};
}

Result<Topic> topic_in(const Value& word, std::string_view key) {
  const Value* topic = word.find(key);
  if (topic != nullptr && topic->is_text()) return parse_topic(topic->text());
  return fail(Errc::bad_value, "no topic", R"(send {"subscribe": "fleet"} or {"unsubscribe": "fleet"})");
}

}  // namespace

Result<std::shared_ptr<LiveSocket>> LiveSocket::open(Gateway& gateway, HttpRequest request) {
  const auto client = gateway.clients.open();
  if (!client) return client.error();
  return std::shared_ptr<LiveSocket>(new LiveSocket(gateway, std::move(request), *client));
}

LiveSocket::LiveSocket(Gateway& gateway, HttpRequest request, ClientId client)
    : gateway_(gateway), request_(std::move(request)), client_(client) {
  gateway_.sockets[client_] = this;
}

LiveSocket::~LiveSocket() {
  gateway_.sockets.erase(client_);
  gateway_.clients.close(client_);
}

void LiveSocket::on_open(std::shared_ptr<WebSocketOut> out) {
  out_ = std::move(out);
  pump();
}

void LiveSocket::on_message(BytesView text) {
  const auto word = parse_json(text);
  const Status obeyed = word ? obey(*word) : Status(word.error());
  if (!obeyed) refuse(obeyed.error());
}

Status LiveSocket::obey(const Value& word) {
  if (word.find("unsubscribe") != nullptr) {
    const auto topic = topic_in(word, "unsubscribe");
    if (!topic) return topic.error();
    gateway_.clients.unsubscribe(client_, *topic);
    return Done{};
  }
  const auto topic = topic_in(word, "subscribe");
  if (!topic) return topic.error();
  return gateway_.clients.subscribe(client_, *topic, resume_of(word));
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
}

void LiveSocket::check_rights() {
  const RequestDecision decision = gateway_.access.check.check(request_.head(), gateway_.steady());
  if (decision.verdict != RequestVerdict::allowed && out_ != nullptr) end(kNotSignedIn, "signed out");
}

/// Its topics end now, also if the client never answers the close.
void LiveSocket::end(std::uint16_t code, const std::string& reason) {
  gateway_.clients.close(client_);
  out_->close(code, reason);
}

}  // namespace trb::gateway
