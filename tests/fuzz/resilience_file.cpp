// resilience.json as a person writes it: any bytes give faults with a hint, or usable settings.
#include <cmath>

#include "common/config/resilience_file.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {

std::vector<Bytes> seeds() {
  return {
      R"({"criteria":{"battery":1,"distance":2,"availability":1},"policy":{"mode":"automatic","conditions":
             {"min_score":0.3,"min_lead":0.05,"max_severity":"CRITICAL"}},"expires_s":300})",
      R"({"judgments":[["distance","battery",2],["distance","availability",3],["battery","availability",2]],
             "policy":{"mode":"ask"},"expires_s":600})",
      R"({"judgments":[["battery","distance",1e9],["distance","availability",1e-9]]})",
      R"({"criteria":{"battery":{"weight":1,"at_least":20,"at_most":90},"payload":{"weight":2,"from":"description",
             "unit":"kg","best":10,"worst":0,"capabilities":["grab"]},"heat":{"from":"sensor","value":"temperature","best":20,
             "worst":80}},"policy":{"mode":"ask","max_moves":3}})",
      R"({"criteria":{"battery":{},"grip":{"from":"robot","best":1,"worst":0}},"judgments":[["grip","battery",3]]})",
      R"({"criteria":{"battery":1e9,"distance":5e-324}})"};
}

void run(BytesView input) {
  const auto json = parse_json(input);
  if (!json) return;
  ConfigFaults faults;
  const ResilienceSettings settings = read_resilience(*json, "resilience.json", faults);
  for (const ConfigFault& fault : faults) {
    require(fault.file == "resilience.json" && !fault.what.empty() && !fault.hint.empty(), "a fault has a cure");
  }
  double sum = 0;
  for (const ReplacementCriterion& one : settings.criteria) {
    require(one.weight >= 0 && one.best != one.worst, "a criterion has a weight and a range");
    require(!one.at_least || !one.at_most || *one.at_least <= *one.at_most, "a bound can be kept");
    sum += one.weight;
  }
  require(settings.criteria.size() <= kMaxCriteria + 3 && std::abs(sum - 1) < 1e-9, "weights sum to 1");
  require(settings.policy.min_score >= 0 && settings.policy.min_score <= 1, "a score is a share");
  require(settings.policy.min_lead >= 0 && settings.policy.min_lead <= 1, "a lead is a share");
  require(settings.expires > Duration{0}, "a proposal holds for some time");
}

}  // namespace trb::fuzz
