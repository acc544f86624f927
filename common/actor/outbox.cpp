#include "common/actor/outbox.hpp"

#include "proto/value.hpp"

namespace trb {

void Outbox::command(std::string target, Body body, std::uint16_t flags) {
  sends.push_back({.type = MessageType::command, .target = std::move(target), .flags = flags, .body = std::move(body)});
}

void Outbox::request(std::string target, Body body) {
  sends.push_back({.type = MessageType::request, .target = std::move(target), .body = std::move(body)});
}

void Outbox::information(std::string target, Body body) {
  sends.push_back({.type = MessageType::information, .target = std::move(target), .body = std::move(body)});
}

void Outbox::reply(const Inbound& to, Body body) {
  if (!to.wants_answer()) return;
  sends.push_back({.type = MessageType::information, .target = to.source, .reply_to = to.id, .body = std::move(body)});
}

void Outbox::nack(const Inbound& to, const Error& error, std::string about) {
  // Of information only a user's own is Nacked: no sender waits for an answer to the middleware's.
  const bool silent = to.type == MessageType::information && !holds_alternative<Opaque>(to.body);
  if (silent || to.reply_to != 0 || to.id == 0) return;
  Nack nack{std::string(errc_name(error.code)), std::string(subtype_of(to.body)), to.target,
            cut_utf8(error.what, 1024),         cut_utf8(error.hint, 1024),       std::move(about)};
  sends.push_back({.type = MessageType::information, .target = to.source, .reply_to = to.id, .body = std::move(nack)});
}

bool Outbox::empty() const {
  return journal.empty() && sends.empty() && logs.empty() && counts.empty();
}

void Outbox::clear() {
  *this = Outbox{};
}

}  // namespace trb
