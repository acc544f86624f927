// alerts: list, one, decision; acknowledge, shelve, unshelve.
#include "common/operator/decide.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/api/lists.hpp"
#include "services/cloud-gateway/io/api/members.hpp"
#include "services/cloud-gateway/io/api/once.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

constexpr std::size_t kMaxShown = 1000;  ///< of AlertDecide
constexpr std::size_t kMaxId = 64;

Error no_shown_task(const std::string& why) {
  return fail(Errc::bad_value, "shown: " + why, R"(write [{"task": ..., "robot": ...}, ...])");
}

Result<TaskForRobot> task_shown(const Value& json) {
  const auto members = Members::of(json, {"task", "robot"});
  if (!members) return no_shown_task(members.error().what);
  const auto task = members->text("task", kMaxId);
  if (!task) return no_shown_task(task.error().what);
  const auto robot = members->text("robot", kMaxId);
  if (!robot) return no_shown_task(robot.error().what);
  return TaskForRobot{*task, *robot};
}

/// The tasks' robots of the proposal that the person saw.
Result<std::vector<TaskForRobot>> shown_in(const Members& body) {
  std::vector<TaskForRobot> out;
  const Value* json = body.value("shown");
  if (json == nullptr) return out;
  if (!json->is_list()) return no_shown_task("is no list");
  if (json->list().size() > kMaxShown) return fail(Errc::too_large, "shown: has too many tasks", "use at most 1000");
  for (const Value& one : json->list()) {
    auto task = task_shown(one);
    if (!task) return task.error();
    out.push_back(std::move(*task));
  }
  return out;
}

/// {"verdict", "robot", "reason", "stands"}: what `trb alert decide` takes; and what was shown. The person is who is
/// signed in.
Result<AlertDecide> decision_of(const Call& call) {
  const auto body = Members::of(call, {"verdict", "robot", "reason", "stands", "shown"});
  if (!body) return body.error();
  const auto verdict = body->one_of<Verdict>("verdict");
  if (!verdict) return verdict.error();
  const auto robot = body->text_or("robot", 64, "");
  if (!robot) return robot.error();
  const auto reason = body->text_or("reason", 1024, "");
  if (!reason) return reason.error();
  const auto stands = body->flag_or("stands", false);
  if (!stands) return stands.error();
  auto shown = shown_in(*body);
  if (!shown) return shown.error();
  AlertDecide out;
  out.alert = call.parameter("alert");
  out.verdict = *verdict;
  out.robot = *robot;
  out.person = call.who().name;
  out.reason = *reason;
  out.stands = *stands;
  out.shown = std::move(*shown);
  return out;
}

void decide_alert(Gateway& gateway, const CallPtr& call) {
  const auto decision = decision_of(*call);
  if (!decision) return call->fail(decision.error());
  call->about = std::string(name_of(decision->verdict));
  if (!decision->robot.empty()) call->about += ", " + decision->robot;
  if (Status good = op::check_decision(*decision); !good) return call->fail(good.error());
  const std::string effect = "decision on alert " + decision->alert + ": " + call->about;
  do_once(gateway, call, effect, [&gateway, call, decision = *decision] {
    op::decide(gateway.session, decision, [call](const Result<Ack>& ack) {
      if (!ack) return call->fail(ack.error());
      call->reply(json_reply(to_json(*ack)));
    });
  });
}

/// What has become of the alarm; clients of the live stream see it as soon as it is on disk.
void reply_alarm(Gateway& gateway, const CallPtr& call, const Status& done) {
  if (!done) return call->fail(done.error());
  gateway.fleet.show_alarms(gateway.now());
  call->reply(json_reply(json_alarm(gateway.access.alarms.of(call->parameter("alert")))));
}

void acknowledge(Gateway& gateway, const CallPtr& call) {
  const std::string& alert = call->parameter("alert");
  reply_alarm(gateway, call, gateway.access.alarms.acknowledge(alert, call->who().name, gateway.now().utc));
}

void shelve(Gateway& gateway, const CallPtr& call) {
  const auto body = Members::of(*call, {"minutes", "reason"});
  if (!body) return call->fail(body.error());
  if (!body->has("minutes")) return call->fail(fail(Errc::missing, "minutes: is missing", "use 1 to 480"));
  const auto minutes = body->number_or("minutes", 0, 1, kLongestShelf / std::chrono::minutes(1));
  if (!minutes) return call->fail(minutes.error());
  const auto reason = body->text("reason", kMaxShelfReason);
  if (!reason) return call->fail(reason.error());
  call->about = *reason;
  const std::string& alert = call->parameter("alert");
  reply_alarm(
      gateway, call,
      gateway.access.alarms.shelve(alert, call->who().name, std::chrono::minutes(*minutes), *reason, gateway.steady()));
}

void unshelve(Gateway& gateway, const CallPtr& call) {
  reply_alarm(gateway, call, gateway.access.alarms.unshelve(call->parameter("alert")));
}

}  // namespace

void add_alert_routes(Gateway& gateway, HandlerTable& table) {
  table.add(Method::get, "/api/v1/alerts", [&](const CallPtr& call) { reply_rows(gateway, call, RowKind::alert); });
  table.add(Method::get, "/api/v1/alerts/{alert}", [&](const CallPtr& call) {
    reply_row(gateway, call, {RowKind::alert, "", call->parameter("alert")});
  });
  table.add(Method::post, "/api/v1/alerts/{alert}/decision", [&](const CallPtr& call) { decide_alert(gateway, call); });
  table.add(Method::post, "/api/v1/alerts/{alert}/acknowledge",
            [&](const CallPtr& call) { acknowledge(gateway, call); });
  table.add(Method::post, "/api/v1/alerts/{alert}/shelve", [&](const CallPtr& call) { shelve(gateway, call); });
  table.add(Method::post, "/api/v1/alerts/{alert}/unshelve", [&](const CallPtr& call) { unshelve(gateway, call); });
}

}  // namespace trb::gateway
