// move, retry and skip of a run's task: a person's decision without an alert.
#include "common/operator/decide.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/api/members.hpp"
#include "services/cloud-gateway/io/api/once.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

constexpr std::size_t kMaxReason = 1024;

AlertDecide decision_on(const Call& call, Verdict verdict) {
  AlertDecide out;
  out.run = call.parameter("run");
  out.tasks = {call.parameter("task")};
  out.verdict = verdict;
  out.person = call.who().name;
  return out;
}

Status read_verdict(const Members& body, AlertDecide& out) {
  const auto reason = body.text_or("reason", kMaxReason, "");
  if (!reason) return reason.error();
  const auto stands = body.flag_or("stands", false);
  if (!stands) return stands.error();
  out.reason = *reason;
  out.stands = *stands;
  return Done{};
}

/// {"robot", "reason", "stands"}: this robot, whether it is proposed or not, if it is able.
Result<AlertDecide> move_of(const Call& call) {
  AlertDecide out = decision_on(call, Verdict::override_);
  const auto body = Members::of(call, {"robot", "reason", "stands"});
  if (!body) return body.error();
  const auto robot = body->text("robot", 64);
  if (!robot) return robot.error();
  out.robot = *robot;
  if (Status read = read_verdict(*body, out); !read) return read.error();
  if (out.reason.empty()) return fail(Errc::missing, "reason: is missing", "say why this robot");
  return out;
}

/// {"reason", "stands"}, or no body.
Result<AlertDecide> verdict_of(const Call& call, Verdict verdict) {
  AlertDecide out = decision_on(call, verdict);
  if (call.request.body.empty()) return out;
  const auto body = Members::of(call, {"reason", "stands"});
  if (!body) return body.error();
  if (Status read = read_verdict(*body, out); !read) return read.error();
  return out;
}

void decide_task(Gateway& gateway, const CallPtr& call, const Result<AlertDecide>& decision) {
  if (!decision) return call->fail(decision.error());
  call->about = decision->robot;
  const std::string effect =
      std::string(name_of(decision->verdict)) + " task " + decision->tasks[0] + " of run " + decision->run;
  do_once(gateway, call, effect, [&gateway, call, decision = *decision] {
    op::decide(gateway.session, decision, [call](const Result<Ack>& ack) {
      if (!ack) return call->fail(ack.error());
      call->reply(json_reply(to_json(*ack)));
    });
  });
}

}  // namespace

void add_task_routes(Gateway& gateway, HandlerTable& table) {
  table.add(Method::post, "/api/v1/runs/{run}/tasks/{task}/move",
            [&](const CallPtr& call) { decide_task(gateway, call, move_of(*call)); });
  table.add(Method::post, "/api/v1/runs/{run}/tasks/{task}/retry",
            [&](const CallPtr& call) { decide_task(gateway, call, verdict_of(*call, Verdict::retry)); });
  table.add(Method::post, "/api/v1/runs/{run}/tasks/{task}/skip",
            [&](const CallPtr& call) { decide_task(gateway, call, verdict_of(*call, Verdict::skip)); });
}

}  // namespace trb::gateway
