// messages: what has passed this node's router; what people send to robots, and ask of them.
#include "common/base/ids.hpp"
#include "common/operator/user_message.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/api/members.hpp"
#include "services/cloud-gateway/io/api/once.hpp"
#include "services/cloud-gateway/io/json_messages.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

constexpr std::uint64_t kMessagePage = 100;
constexpr std::uint64_t kMaxMessagePage = 500;
constexpr std::int64_t kWait_s = 5;
constexpr std::int64_t kMaxWait_s = 30;
constexpr std::size_t kMaxWord = 64;

/// One of an enumeration's names in the query; empty: not there.
template <class E>
Result<std::optional<E>> query_name(const Call& call, std::string_view key) {
  const std::string given = call.query(key);
  if (given.empty()) return std::optional<E>();
  std::string all;
  constexpr auto kNames = enum_names(E{});
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNames[i] == given) return std::optional(static_cast<E>(i));
    all += (i == 0 ? "" : ", ") + std::string(kNames[i]);
  }
  return fail(Errc::bad_value, std::string(key) + ": '" + given.substr(0, kMaxWord) + "'", "use one of: " + all);
}

Status read_page(const Call& call, MessageQuery& out) {
  const auto before = call.query_number("cursor", out.before, out.before);
  if (!before) return before.error();
  const auto limit = call.query_number("limit", kMessagePage, kMaxMessagePage);
  if (!limit) return limit.error();
  if (*limit == 0) return fail(Errc::bad_value, "limit: 0", "use 1 to " + std::to_string(kMaxMessagePage));
  out.before = *before;
  out.most = static_cast<std::size_t>(*limit);
  return Done{};
}

/// `?node=` or `?robot=`, `?subtype=`, `?type=`, `?phase=`, `?limit=`, `?cursor=`.
Result<MessageQuery> message_query(const Call& call) {
  MessageQuery out;
  out.node = call.query("node");
  if (out.node.empty()) out.node = call.query("robot");
  out.subtype = call.query("subtype");
  const auto type = query_name<MessageType>(call, "type");
  if (!type) return type.error();
  out.type = *type;
  const auto phase = query_name<CostPhase>(call, "phase");
  if (!phase) return phase.error();
  out.phase = *phase;
  if (Status page = read_page(call, out); !page) return page.error();
  return out;
}

void list_messages(const Gateway& gateway, const CallPtr& call) {
  const auto query = message_query(*call);
  if (!query) return call->fail(query.error());
  const MessageLog::Found found = gateway.messages.find(*query);
  JsonList items;
  for (const PassedMessage* one : found.messages) items.add(json_message(*one));
  JsonObject out;
  out.raw("items", items.done()).text("next", found.next == 0 ? "" : std::to_string(found.next));
  call->reply(json_reply(out.raw("phases", json_phases(gateway.messages.counts())).done()));
}

// ---- sending

/// Text goes as it is; anything else as JSON.
std::string data_in(const Members& body) {
  const Value* data = body.value("data");
  if (data == nullptr || data->is_null()) return "";
  return data->is_text() ? data->text() : dump_json(*data);
}

/// The node's router would send the middleware's own words, too, and has some of them signed: those have routes that
/// check who decides what.
Status check_word(const std::string& subtype) {
  if (!is_valid_word(subtype)) return fail(Errc::bad_value, "subtype: is no word", "use letters, digits, '_' and '-'");
  if (!is_reserved(subtype)) return Done{};
  return fail(Errc::not_permitted, "subtype: '" + subtype + "' is a word of the middleware",
              "use the route for it: see /api/v1/openapi.json");
}

Result<Send> send_in(const Gateway& gateway, const Members& body, MessageType type) {
  const auto target = body.text("target", kMaxWord);
  if (!target) return target.error();
  const auto subtype = body.text("subtype", kMaxWord);
  if (!subtype) return subtype.error();
  if (Status free = check_word(*subtype); !free) return free.error();
  const auto take = body.flag_or("take", false);
  if (!take) return take.error();
  const auto wait = body.number_or("timeout_s", kWait_s, 1, kMaxWait_s);
  if (!wait) return wait.error();
  auto content = op::user_body(*subtype, data_in(body));
  if (!content) return content.error();
  if (gateway.book.find({RowKind::node, *target, ""}) == nullptr)
    return fail(Errc::unknown_target, "target: no node '" + *target + "'", "GET /api/v1/nodes");
  return Send{.type = type,
              .target = *target,
              .flags = static_cast<std::uint16_t>(*take ? kFlagTakeControl : 0),
              .remaining_ms = static_cast<std::uint32_t>(*wait * 1000),
              .body = std::move(*content)};
}

void ask(Gateway& gateway, const CallPtr& call, const Send& send) {
  gateway.session.request(
      send,
      [call](const Result<Message>& answer) {
        if (!answer) return call->fail(answer.error());
        call->reply(json_reply(JsonObject().raw("answer", message_to_json(*answer)).done()));
      },
      std::chrono::milliseconds(send.remaining_ms));
}

void inform(Gateway& gateway, const CallPtr& call, const Send& send) {
  op::send_information(gateway.session, send, [call](const Status& sent) {
    if (!sent) return call->fail(sent.error());
    call->reply(json_reply(R"({"answer":null})"));
  });
}

/// Done once, and on record with what was sent to whom.
void send_once(Gateway& gateway, const CallPtr& call, const Send& send) {
  call->about = send.target + " " + std::string(name_of(send.type)) + " " + std::string(subtype_of(send.body));
  do_once(gateway, call, call->about, [&gateway, call, send] {
    send.type == MessageType::information ? inform(gateway, call, send) : ask(gateway, call, send);
  });
}

/// {"target", "type": "command" or "information", "subtype", "data", "take", "timeout_s"}
void send_message(Gateway& gateway, const CallPtr& call) {
  const auto body = Members::of(*call, {"target", "type", "subtype", "data", "take", "timeout_s"});
  if (!body) return call->fail(body.error());
  const auto type = body->one_of<MessageType>("type");
  if (!type) return call->fail(type.error());
  if (*type != MessageType::command && *type != MessageType::information) {
    return call->fail(fail(Errc::bad_value, "type: '" + std::string(name_of(*type)) + "'",
                           "use command or information; requests go to /api/v1/messages/requests"));
  }
  const auto send = send_in(gateway, *body, *type);
  if (!send) return call->fail(send.error());
  send_once(gateway, call, *send);
}

/// {"target", "subtype", "data", "timeout_s"}
void request_message(Gateway& gateway, const CallPtr& call) {
  const auto body = Members::of(*call, {"target", "subtype", "data", "timeout_s"});
  if (!body) return call->fail(body.error());
  const auto send = send_in(gateway, *body, MessageType::request);
  if (!send) return call->fail(send.error());
  send_once(gateway, call, *send);
}

}  // namespace

void add_message_routes(Gateway& gateway, HandlerTable& table) {
  table.add(Method::get, "/api/v1/messages", [&](const CallPtr& call) { list_messages(gateway, call); });
  table.add(Method::post, "/api/v1/messages", [&](const CallPtr& call) { send_message(gateway, call); });
  table.add(Method::post, "/api/v1/messages/requests", [&](const CallPtr& call) { request_message(gateway, call); });
}

}  // namespace trb::gateway
