// scenarios/preflight.
#include "common/operator/preflight.hpp"

#include "common/scenario/condition.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/api/scenario_body.hpp"
#include "services/cloud-gateway/io/json_rows.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

std::string json_texts(const std::vector<std::string>& texts) {
  JsonList out;
  for (const std::string& one : texts) out.add(json_quoted(one));
  return out.done();
}

std::string json_robot(const op::RobotPreflight& one) {
  JsonObject out;
  out.text("robot", one.robot).raw("tasks", json_texts(one.tasks)).flag("ready", one.why.empty());
  out.flag("asked", one.asked).flag("answers", one.answers).raw("why", json_texts(one.why));
  if (!one.answers) return out.done();
  out.raw("answer_ms", dump_json(Value{one.answer_ms})).text("value", one.value);
  return out.raw("answer", json_value(one.answer)).done();
}

std::string json_sensor(const op::SensorPreflight& one) {
  JsonObject out;
  out.text("task", one.task).text("sensor", sensor_text(one.condition)).text("node", one.node);
  out.flag("ready", one.why.empty()).text("why", one.why);
  if (one.reading) out.raw("reading", json_record(*one.reading));
  if (one.why.empty() && one.reading) out.flag("holds", holds(one.condition, *one.reading));
  return out.done();
}

std::string json_preflight(const op::Preflight& preflight) {
  JsonList robots;
  for (const op::RobotPreflight& one : preflight.robots) robots.add(json_robot(one));
  JsonList sensors;
  for (const op::SensorPreflight& one : preflight.sensors) sensors.add(json_sensor(one));
  JsonObject out;
  out.flag("ready", preflight.is_ready()).raw("faults", json_scenario_faults(preflight.faults));
  out.raw("without_spare", json_no_spares(preflight.without_spare)).raw("robots", robots.done());
  return out.raw("sensors", sensors.done()).done();
}

void run_preflight(Gateway& gateway, const CallPtr& call) {
  const auto body = body_of(*call);
  if (!body) return call->fail(body.error());
  ConfigFaults faults;
  Scenario scenario = scenario_of(*body, faults);
  if (!faults_that_stop(faults).empty()) {
    op::Preflight refused;
    refused.faults = std::move(faults);
    return call->reply(json_reply(json_preflight(refused)));
  }
  op::preflight(gateway.session, std::move(scenario), kScenarioFile, [call](const Result<op::Preflight>& done) {
    if (!done) return call->fail(done.error());
    call->reply(json_reply(json_preflight(*done)));
  });
}

}  // namespace

void add_preflight_route(Gateway& gateway, HandlerTable& table) {
  table.add(Method::post, "/api/v1/scenarios/preflight", [&](const CallPtr& call) { run_preflight(gateway, call); });
}

}  // namespace trb::gateway
