// robots: read, stop, release, repaired, retired, returned.
#include <algorithm>
#include <type_traits>

#include "common/operator/order_robots.hpp"
#include "proto/bodies/robot.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/api/conditional.hpp"
#include "services/cloud-gateway/io/api/lists.hpp"
#include "services/cloud-gateway/io/api/members.hpp"
#include "services/cloud-gateway/io/api/once.hpp"
#include "services/cloud-gateway/io/json_text.hpp"
#include "services/cloud-gateway/io/skill_schemas.hpp"

namespace trb::gateway {
namespace {

constexpr std::size_t kMaxUseReason = 255;
constexpr Duration kStopWait = std::chrono::seconds(3);

RowKey robot_key(RowKind kind, const Call& call) {
  return {kind, call.parameter("robot"), ""};
}

bool is_robot(const Gateway& gateway, const std::string& id) {
  return gateway.book.find({RowKind::robot, id, ""}) != nullptr;
}

/// Before the first list of the fleet nobody knows who is a robot, and a node that has just joined is in no list yet: a
/// stop goes to it. The router says if there is no such node.
bool may_be_robot(const Gateway& gateway, const std::string& id) {
  const auto has_node = [&](const std::string& node) {
    return gateway.book.find({RowKind::node, node, ""}) != nullptr;
  };
  return is_robot(gateway, id) || has_node(id) || !has_node(gateway.session.node());
}

std::vector<std::string> all_robots(const Gateway& gateway) {
  std::vector<std::string> out;
  gateway.book.each(RowKind::robot, [&](const Row& row) { out.push_back(row.key.node); });
  return out;
}

std::string json_orders(const std::vector<op::RobotOrder>& orders) {
  JsonList out;
  for (const op::RobotOrder& one : orders) {
    out.add(JsonObject().text("robot", one.robot).text("state", one.state).text("text", one.text).done());
  }
  return JsonObject().raw("robots", out.done()).done();
}

void give_order(Gateway& gateway, const CallPtr& call, const std::vector<std::string>& robots, const Body& body) {
  order_once(gateway, call, "robot", [&gateway, call, robots, body] {
    op::order_robots(gateway.session, robots, body, kStopWait, [call](const std::vector<op::RobotOrder>& orders) {
      call->outcome = op::outcome_in_words(orders);
      call->is_not_done = !orders.empty() && std::ranges::all_of(orders, &op::RobotOrder::surely_not_told);
      call->reply(json_reply(json_orders(orders)));
    });
  });
}

template <class Order>
void order_one(Gateway& gateway, const CallPtr& call) {
  const auto reason = reason_in(*call, kMaxUseReason);
  if (!reason) return call->fail(reason.error());
  const bool is_known = std::is_same_v<Order, Stop> ? may_be_robot(gateway, call->parameter("robot"))
                                                    : is_robot(gateway, call->parameter("robot"));
  if (!is_known) {
    return call->reply(problem_reply(404, "missing", "there is no such robot", "GET /api/v1/robots"));
  }
  give_order(gateway, call, {call->parameter("robot")}, Order{with_name(*call, *reason, kMaxUseReason)});
}

/// A stop without a body is a stop. A stop for all does not wait for a list of the fleet: those that are known are told
/// at once.
void stop_all(Gateway& gateway, const CallPtr& call) {
  const auto reason = reason_in(*call, kMaxUseReason);
  if (!reason) return call->fail(reason.error());
  give_order(gateway, call, all_robots(gateway), Stop{with_name(*call, *reason, kMaxUseReason)});
}

void command_robot(Gateway& gateway, const CallPtr& call, const Body& body) {
  order_once(gateway, call, "robot", [&gateway, call, body] {
    gateway.session.command(call->parameter("robot"), body, [call](const Result<Message>& answer) {
      if (!answer) return call->fail(answer.error());
      call->reply(empty_reply());
    });
  });
}

void retire(Gateway& gateway, const CallPtr& call) {
  const auto body = Members::of(*call, {"reason"});
  if (!body) return call->fail(body.error());
  const auto reason = body->text("reason", kMaxUseReason);
  if (!reason) return call->fail(reason.error());
  command_robot(gateway, call, TakeOutOfUse{{"", {}, *reason, 0, true, call->who().name}});
}

void repaired(Gateway& gateway, const CallPtr& call) {
  if (call->request.body.empty()) return command_robot(gateway, call, TakeIntoUse{"", false, call->who().name});
  const auto body = Members::of(*call, {"capability"});
  if (!body) return call->fail(body.error());
  const auto capability = body->text_or("capability", 64, "");
  if (!capability) return call->fail(capability.error());
  command_robot(gateway, call, TakeIntoUse{*capability, false, call->who().name});
}

/// The profile's row, and the skills' parameters as JSON Schema beside it.
void reply_skills(const Gateway& gateway, const CallPtr& call) {
  const RowKey key = robot_key(RowKind::profile, *call);
  const Row* row = gateway.book.find(key);
  const auto* profile = row == nullptr ? nullptr : std::get_if<NodeProfile>(&row->content);
  if (profile == nullptr) return reply_row(gateway, call, key);  // which says that there is none
  std::string json = *json_of(*row);
  json.back() = ',';
  json += "\"schemas\":" + dump_json(skill_schemas(*profile)) + "}";
  reply_tagged(call, etag_of(gateway.clients.instance(), *row), json_reply(std::move(json)));
}

void returned(Gateway& gateway, const CallPtr& call) {
  command_robot(gateway, call, TakeIntoUse{"", true, call->who().name});
}

}  // namespace

void add_robot_routes(Gateway& gateway, HandlerTable& table) {
  table.add(Method::get, "/api/v1/robots", [&](const CallPtr& call) { reply_rows(gateway, call, RowKind::robot); });
  for (const char* path : {"/api/v1/robots/{robot}", "/api/v1/robots/{robot}/live"}) {
    table.add(Method::get, path,
              [&](const CallPtr& call) { reply_row(gateway, call, robot_key(RowKind::robot, *call)); });
  }
  table.add(Method::get, "/api/v1/robots/{robot}/skills", [&](const CallPtr& call) { reply_skills(gateway, call); });
  table.add(Method::post, "/api/v1/robots/{robot}/stop", of_gateway(gateway, order_one<Stop>));
  table.add(Method::post, "/api/v1/robots/{robot}/release", of_gateway(gateway, order_one<Release>));
  table.add(Method::post, "/api/v1/stop", of_gateway(gateway, stop_all));
  table.add(Method::post, "/api/v1/robots/{robot}/retired", of_gateway(gateway, retire));
  table.add(Method::post, "/api/v1/robots/{robot}/repaired", of_gateway(gateway, repaired));
  table.add(Method::post, "/api/v1/robots/{robot}/returned", of_gateway(gateway, returned));
}

}  // namespace trb::gateway
