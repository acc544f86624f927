#include "services/cloud-gateway/io/api/scenario_body.hpp"

#include "common/scenario/definition.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {

Scenario scenario_of(const Value& json, ConfigFaults& faults) {
  const Value* inner = json.find("scenario");
  return read_scenario(inner != nullptr ? *inner : json, kScenarioFile, faults);
}

HttpReply faults_reply(const ConfigFaults& faults) {
  return problem_reply(problem_of(faults));
}

std::string json_scenario_faults(const ConfigFaults& faults) {
  JsonList out;
  for (const ConfigFault& one : faults) {
    JsonObject fault;
    fault.text("pointer", pointer_of(one.key)).text("detail", one.what).text("hint", one.hint);
    out.add(fault.flag("warning", one.may_wait).done());
  }
  return out.done();
}

std::string json_no_spares(const std::vector<NoSpare>& without) {
  JsonList out;
  for (const NoSpare& one : without) {
    out.add(JsonObject().text("task", one.task).text("robot", one.robot).text("why", one.why).done());
  }
  return out.done();
}

}  // namespace trb::gateway
