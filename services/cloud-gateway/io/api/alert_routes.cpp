// alerts: list, one, decision.
#include "common/operator/decide.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/api/lists.hpp"
#include "services/cloud-gateway/io/api/members.hpp"
#include "services/cloud-gateway/io/api/once.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

/// {"verdict", "robot", "reason", "stands"}: what `trb alert decide` takes. The person is who is signed in.
Result<AlertDecide> decision_of(const Call& call) {
  const auto body = Members::of(call, {"verdict", "robot", "reason", "stands"});
  if (!body) return body.error();
  const auto verdict = body->one_of<Verdict>("verdict");
  if (!verdict) return verdict.error();
  const auto robot = body->text_or("robot", 64, "");
  if (!robot) return robot.error();
  const auto reason = body->text_or("reason", 1024, "");
  if (!reason) return reason.error();
  const auto stands = body->flag_or("stands", false);
  if (!stands) return stands.error();
  AlertDecide out;
  out.alert = call.parameter("alert");
  out.verdict = *verdict;
  out.robot = *robot;
  out.person = call.who().name;
  out.reason = *reason;
  out.stands = *stands;
  return out;
}

void decide_alert(Gateway& gateway, const CallPtr& call) {
  const auto decision = decision_of(*call);
  if (!decision) return call->fail(decision.error());
  if (Status good = op::check_decision(*decision); !good) return call->fail(good.error());
  const std::string effect = "decision on alert " + decision->alert;
  do_once(gateway, call, effect, [&gateway, call, decision = *decision] {
    op::decide(gateway.session, decision, [call](const Result<Ack>& ack) {
      if (!ack) return call->fail(ack.error());
      call->reply(json_reply(to_json(*ack)));
    });
  });
}

}  // namespace

void add_alert_routes(Gateway& gateway, HandlerTable& table) {
  table.add(Method::get, "/api/v1/alerts", [&](const CallPtr& call) { reply_rows(gateway, call, RowKind::alert); });
  table.add(Method::get, "/api/v1/alerts/{alert}", [&](const CallPtr& call) {
    reply_row(gateway, call, {RowKind::alert, "", call->parameter("alert")});
  });
  table.add(Method::post, "/api/v1/alerts/{alert}/decision", [&](const CallPtr& call) { decide_alert(gateway, call); });
}

}  // namespace trb::gateway
