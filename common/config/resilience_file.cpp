#include "common/config/resilience_file.hpp"

#include <vector>

#include "common/config/json_file.hpp"
#include "common/fleet/object_reader.hpp"
#include "common/ranking/pairwise.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxPairs = 3;
constexpr double kMaxRatio = 0.10;  ///< Saaty's tenth
const std::vector<std::string> kCriteria = {"battery", "distance", "availability"};
const std::vector<Judgment> kFigure8 = {
    {"distance", "battery", 2}, {"distance", "availability", 3}, {"battery", "availability", 2}};
constexpr const char* kSaatysScale = R"(write ["battery", "distance", 3]: battery counts 3 times as much as distance)";

Result<Priorities> weigh_criteria(const std::vector<Judgment>& judgments) {
  return weigh("judgments", kCriteria, {{1, judgments, ""}}, WeightMethod::eigenvector);
}

ReplacementWeights to_weights(const std::vector<double>& of) {
  return {of[0], of[1], of[2]};
}

std::optional<Judgment> read_judgment(const Value& json, const std::string& path, const FileFaults& faults) {
  if (json.is_list() && json.list().size() == 3) {
    const Value::List& list = json.list();
    if (list[0].is_text() && list[1].is_text() && list[2].is_number()) {
      return Judgment{list[0].text(), list[1].text(), list[2].number()};
    }
  }
  faults.add(path, "is no judgment", kSaatysScale);
  return std::nullopt;
}

void read_judgments(const Value::List& list, const FileFaults& faults, ReplacementWeights& out) {
  std::vector<Judgment> judgments;
  for (std::size_t i = 0; i < list.size(); ++i) {
    auto one = read_judgment(list[i], "judgments[" + std::to_string(i) + "]", faults);
    if (!one) return;
    judgments.push_back(std::move(*one));
  }
  const auto weighed = weigh_criteria(judgments);
  if (!weighed) return faults.add("judgments", weighed.error().what, weighed.error().cure);
  if (weighed->consistency.cr > kMaxRatio) {
    const Judgment& worst = *weighed->worst;
    return faults.add("judgments",
                      "contradict each other: consistency ratio " + short_number(weighed->consistency.cr) + " over " +
                          short_number(kMaxRatio),
                      "of " + worst.a + " to " + worst.b + ", " + short_number(weighed->fits) + " would fit");
  }
  out = to_weights(weighed->weights);
}

void read_criteria(const Value& json, const FileFaults& faults, ReplacementWeights& out) {
  ObjectReader reader(json, "criteria", faults);
  constexpr Range kWeight{0, 1e9};
  std::vector<double> weights;
  double sum = 0;
  for (const std::string& name : kCriteria) {
    weights.push_back(reader.number(name, Need::optional, kWeight).value_or(0));
    sum += weights.back();
  }
  reader.refuse_unknown_keys();
  if (!(sum > 0)) return faults.add("criteria", "all count nothing", R"(write {"battery": 1, "distance": 2})");
  for (double& weight : weights) weight /= sum;
  out = to_weights(weights);
}

void read_conditions(const Value& json, const FileFaults& faults, ReplacementPolicy& out) {
  ObjectReader reader(json, "policy.conditions", faults);
  constexpr Range kShare{0, 1};
  out.min_score = reader.number("min_score", Need::optional, kShare).value_or(out.min_score);
  out.min_lead = reader.number("min_lead", Need::optional, kShare).value_or(out.min_lead);
  out.max_severity = reader.one_of<Severity>("max_severity", Need::optional).value_or(out.max_severity);
  reader.refuse_unknown_keys();
}

void read_policy(const Value& json, const FileFaults& faults, ReplacementPolicy& out) {
  ObjectReader reader(json, "policy", faults);
  out.automatic = reader.choice("mode", Need::required, {"ask", "automatic"}).value_or(0) == 1;
  out.asks_who_begins = reader.choice("bind", Need::optional, {"automatic", "ask"}).value_or(0) == 1;
  constexpr std::int64_t kMostMoves = 16;
  const auto moves = reader.integer("max_moves", Need::optional, 1, kMostMoves);
  out.max_moves = moves ? static_cast<std::uint32_t>(*moves) : out.max_moves;
  if (const Value* conditions = reader.value("conditions", Need::optional)) {
    read_conditions(*conditions, faults, out);
  }
  reader.refuse_unknown_keys();
}

}  // namespace

ResilienceSettings default_resilience() {
  static const ReplacementWeights kWeights = to_weights(weigh_criteria(kFigure8)->weights);
  ResilienceSettings out;
  out.weights = kWeights;
  return out;
}

ResilienceSettings read_resilience(const Value& json, const std::string& file, ConfigFaults& faults) {
  ResilienceSettings out = default_resilience();
  const FileFaults sink(file, faults);
  ObjectReader reader(json, "", sink);
  const Value* criteria = reader.value("criteria", Need::optional);
  const Value::List* judgments = reader.list("judgments", Need::optional, kMaxPairs);
  if (criteria != nullptr && judgments != nullptr) {
    sink.add("criteria", "and judgments both say what counts", "keep one of them");
  } else if (criteria != nullptr) {
    read_criteria(*criteria, sink, out.weights);
  } else if (judgments != nullptr) {
    read_judgments(*judgments, sink, out.weights);
  }
  if (const Value* policy = reader.value("policy", Need::optional)) read_policy(*policy, sink, out.policy);
  if (const auto s = reader.number("expires_s", Need::optional, kSeconds)) out.expires = seconds(*s);
  reader.refuse_unknown_keys();
  return out;
}

ResilienceSettings read_resilience_file(const std::string& node_dir, ConfigFaults& faults) {
  const auto json = load_json(node_dir + "/resilience.json", "", {"resilience.json", faults});
  return json ? read_resilience(*json, "resilience.json", faults) : default_resilience();
}

}  // namespace trb
