#include "services/router/core/own_messages.hpp"

#include <utility>

#include "services/router/core/nack.hpp"

namespace trb::router {
namespace {

std::string_view hint_for(Errc reason) {
  switch (reason) {
    case Errc::unknown_target:
      return "see trb route list for the nodes that are known";
    case Errc::peer_expired:
    case Errc::peer_unreachable:
      return "see trb route list; check the node's power and cable";
    case Errc::queue_full:
      return "send less, or wait";
    case Errc::no_service:
      return "see trb service list on the target; is the service in its node.json?";
    case Errc::not_permitted:
      return "it is not for this role or service to say: trb help rights";
    case Errc::expired:
      return "give the message more time";
    case Errc::not_confirmed:
      return "it may or may not have come: ask for the state before you say it again";
    case Errc::bad_value:
      return "only information goes to every node, and only information answers";
    default:
      return "";
  }
}

}  // namespace

Message OwnMessages::plain(std::string_view subtype, const std::string& target, Bytes data) {
  Message message;
  message.type = MessageType::information;
  message.subtype = subtype;
  message.source = node_.id();
  message.target = target;
  message.id = next_id();
  message.data = std::move(data);
  return message;
}

std::optional<Message> OwnMessages::make(const std::string& target, std::uint64_t reply_to, const Body& body,
                                         Effects& out) {
  auto data = pack_body(body);
  Message message = plain(subtype_of(body), target, {});
  message.reply_to = reply_to;
  if (data) {
    message.data = std::move(*data);
    return message;
  }
  const Error& why = data.error();
  out.count("dropped." + std::string(errc_name(why.code)));
  out.log(LogLevel::error, "not_sent", message.subtype + " for '" + target + "': " + why.text());
  if (reply_to == 0) return std::nullopt;
  message.data = encode(Nack{std::string(errc_name(why.code)), message.subtype, target, why.what, why.hint});
  message.subtype = Nack::kSubtype;
  return message;
}

void OwnMessages::send(const Link& link, const Body& body, Effects& out) {
  if (auto message = make(link.peer, 0, body, out)) out.add(LinkSend{link.id, std::move(*message)});
}

void OwnMessages::send_bus(ConnectionId to, std::uint64_t reply_to, const Body& body, Effects& out) {
  if (auto message = make(node_.id(), reply_to, body, out)) out.add(BusSend{to, std::move(*message)});
}

Message OwnMessages::nack(const HeaderView& header, Errc reason) {
  const std::string target(header.target);
  Message message = plain(Nack::kSubtype, std::string(header.source),
                          encode(Nack{std::string(errc_name(reason)), std::string(header.subtype), target,
                                      "router of " + node_.id() + ": " + std::string(header.subtype) + " for '" +
                                          target + "' not delivered",
                                      std::string(hint_for(reason))}));
  message.reply_to = header.id;
  return message;
}

std::optional<Message> OwnMessages::nack_elsewhere(const HeaderView& header, Errc reason, Effects& out) {
  out.count(undelivered_counter(reason));
  return deserves_nack_elsewhere(header) ? std::optional(nack(header, reason)) : std::nullopt;
}

}  // namespace trb::router
