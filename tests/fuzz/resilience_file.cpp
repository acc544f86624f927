// resilience.json as a person writes it: any bytes give faults with a cure, or settings that can be used.
#include <cmath>

#include "common/config/resilience_file.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {

std::vector<Bytes> seeds() {
  return {R"({"criteria":{"battery":1,"distance":2,"availability":1},"policy":{"mode":"automatic","conditions":
             {"min_score":0.3,"min_lead":0.05,"max_severity":"CRITICAL"}},"expires_s":300})",
          R"({"judgments":[["distance","battery",2],["distance","availability",3],["battery","availability",2]],
             "policy":{"mode":"ask"},"expires_s":600})",
          R"({"judgments":[["battery","distance",1e9],["distance","availability",1e-9]]})",
          R"({"criteria":{"battery":1e9,"distance":5e-324}})"};
}

void run(BytesView input) {
  const auto json = parse_json(input);
  if (!json) return;
  ConfigFaults faults;
  const ResilienceSettings settings = read_resilience(*json, "resilience.json", faults);
  for (const ConfigFault& fault : faults) {
    require(fault.file == "resilience.json" && !fault.what.empty() && !fault.cure.empty(), "a fault has a cure");
  }
  const ReplacementWeights& of = settings.weights;
  require(of.battery >= 0 && of.distance >= 0 && of.availability >= 0, "weights are not negative");
  require(std::abs(of.battery + of.distance + of.availability - 1) < 1e-9, "weights sum to 1");
  require(settings.policy.min_score >= 0 && settings.policy.min_score <= 1, "a score is a share");
  require(settings.policy.min_lead >= 0 && settings.policy.min_lead <= 1, "a lead is a share");
  require(settings.expires > Duration{0}, "a proposal holds for some time");
}

}  // namespace trb::fuzz
