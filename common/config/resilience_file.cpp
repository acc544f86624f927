#include "common/config/resilience_file.hpp"

#include <algorithm>
#include <vector>

#include "common/base/ids.hpp"
#include "common/config/json_file.hpp"
#include "common/fleet/object_reader.hpp"
#include "common/ranking/pairwise.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxPairs = kMaxCriteria * (kMaxCriteria - 1) / 2;
constexpr double kMaxRatio = 0.10;  ///< Saaty's tenth
constexpr Range kWeight{0, 1e9};
constexpr Range kMeasured{-1e12, 1e12};
const std::vector<Judgment> kFigure8 = {
    {"distance", "battery", 2}, {"distance", "availability", 3}, {"battery", "availability", 2}};
constexpr const char* kSaatysScale = R"(write ["battery", "distance", 3]: battery counts 3 times as much as distance)";

using Criteria = std::vector<ReplacementCriterion>;

/// The paper's three, with weight 0.
Criteria paper_criteria() {
  return {{"battery", CriterionSource::charge, 0, "", "%", 100, 0},
          {"distance", CriterionSource::distance, 0, "", "m", 0, 100},
          {"availability", CriterionSource::availability, 0, "", "", 100, 0}};
}

ReplacementCriterion* find(Criteria& criteria, std::string_view name) {
  const auto at = std::ranges::find(criteria, name, &ReplacementCriterion::name);
  return at == criteria.end() ? nullptr : &*at;
}

Result<Priorities> weigh_criteria(const std::vector<std::string>& names, const std::vector<Judgment>& judgments) {
  return weigh("judgments", names, {{1, judgments, ""}}, WeightMethod::eigenvector);
}

void set_weights(const std::vector<std::string>& names, const std::vector<double>& weights, Criteria& criteria) {
  for (std::size_t i = 0; i < names.size(); ++i) find(criteria, names[i])->weight = weights[i];
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

void read_judgments(const Value::List& list, const std::vector<std::string>& names, const FileFaults& faults,
                    Criteria& out) {
  std::vector<Judgment> judgments;
  for (std::size_t i = 0; i < list.size(); ++i) {
    auto one = read_judgment(list[i], "judgments[" + std::to_string(i) + "]", faults);
    if (!one) return;
    judgments.push_back(std::move(*one));
  }
  const auto weighed = weigh_criteria(names, judgments);
  if (!weighed) return faults.add("judgments", weighed.error().what, weighed.error().hint);
  if (weighed->consistency.cr > kMaxRatio) {
    const Judgment& worst = *weighed->worst;
    return faults.add("judgments",
                      "contradict each other: consistency ratio " + short_number(weighed->consistency.cr) + " over " +
                          short_number(kMaxRatio),
                      "of " + worst.a + " to " + worst.b + ", " + short_number(weighed->fits) + " would fit");
  }
  set_weights(names, weighed->weights, out);
}

/// The source of its value: of the operator's own criteria.
void read_source(ObjectReader& reader, ReplacementCriterion& out) {
  constexpr CriterionSource kSources[] = {CriterionSource::robot, CriterionSource::description,
                                          CriterionSource::sensor};
  out.from = kSources[reader.choice("from", Need::required, {"robot", "description", "sensor"}).value_or(0)];
  out.value = reader.text("value", Need::optional, kMaxCriterionValue).value_or(out.name);
  out.unit = reader.text("unit", Need::optional, 16).value_or("");
}

/// Its best and its worst value.
void read_scale(ObjectReader& reader, Need need, ReplacementCriterion& out) {
  out.best = reader.number("best", need, kMeasured).value_or(out.best);
  out.worst = reader.number("worst", need, kMeasured).value_or(out.worst);
  if (out.best != out.worst) return;
  reader.faults().add(reader.path("best"), "is the worst", "name what is best, and what is worst");
}

void read_bounds(ObjectReader& reader, ReplacementCriterion& out) {
  out.at_least = reader.number("at_least", Need::optional, kMeasured);
  out.at_most = reader.number("at_most", Need::optional, kMeasured);
  if (out.at_least && out.at_most && *out.at_least > *out.at_most) {
    reader.faults().add(reader.path("at_least"), "is over at_most: no robot has it", "write the lower one here");
  }
}

/// `judged`: its weight comes from the judgments.
std::optional<ReplacementCriterion> read_criterion(const Value& json, ReplacementCriterion out, bool judged,
                                                   const FileFaults& faults, const ConfigFaults& found) {
  const std::string path = "criteria." + out.name;
  const bool own = out.from > CriterionSource::availability;
  if (json.is_number() && !own && !judged) {
    out.weight = json.number();
    if (kWeight.holds(out.weight)) return out;
    faults.add(path, "is no weight", "write a number of " + kWeight.text());
    return std::nullopt;
  }
  if (!json.is_object()) {
    faults.add(path, judged ? "is a weight, and the judgments say what counts" : "is no criterion",
               own || judged ? R"(write {"from": "robot", "best": 10, "worst": 0, ...}: config/resilience/README.md)"
                             : "write a weight");
    return std::nullopt;
  }
  const std::size_t before = found.size();
  ObjectReader reader(json, path, faults);
  if (own) read_source(reader, out);
  read_scale(reader, own ? Need::required : Need::optional, out);
  out.weight = judged ? 0 : reader.number("weight", Need::optional, kWeight).value_or(1);
  read_bounds(reader, out);
  out.capabilities = reader.texts("capabilities", Need::optional, kMaxCriteria);
  reader.refuse_unknown_keys();
  return found.size() == before ? std::optional(std::move(out)) : std::nullopt;
}

/// The listed names; empty: they are faulty.
std::vector<std::string> read_listed(const Value& json, bool judged, const FileFaults& faults,
                                     const ConfigFaults& found, Criteria& out) {
  std::vector<std::string> names;
  if (!json.is_object()) {
    faults.add("criteria", "is no object", R"(write {"battery": 1, "distance": 2})");
    return {};
  }
  bool good = true;
  for (const auto& [name, value] : json.object()) {
    if (name == "_comment") continue;
    const bool twice = std::ranges::find(names, name) != names.end();
    if (twice || !is_valid_id(name) || names.size() == kMaxCriteria) {
      faults.add("criteria." + cut_utf8(name, 64), twice ? "is there twice" : "is no criterion's name, or one too many",
                 "use small letters, digits, _ and -, 16 criteria at most");
      return {};
    }
    ReplacementCriterion* known = find(out, name);
    auto read = read_criterion(value, known != nullptr ? *known : ReplacementCriterion{name, CriterionSource::robot},
                               judged, faults, found);
    good = good && read;
    if (!read) continue;
    names.push_back(name);
    known != nullptr ? void(*known = std::move(*read)) : out.push_back(std::move(*read));
  }
  return good ? names : std::vector<std::string>{};
}

void read_weights(const FileFaults& faults, Criteria& out) {
  double sum = 0;
  for (const ReplacementCriterion& one : out) sum += one.weight;
  if (!(sum > 0)) return faults.add("criteria", "all count nothing", R"(write {"battery": 1, "distance": 2})");
  for (ReplacementCriterion& one : out) one.weight /= sum;
}

/// The criteria: with weights, or with judgments about the listed names.
void read_criteria(const Value* criteria, const Value::List* judgments, const FileFaults& faults,
                   const ConfigFaults& found, ResilienceSettings& out) {
  Criteria read = paper_criteria();
  std::vector<std::string> names = {"battery", "distance", "availability"};
  const std::size_t before = found.size();
  if (criteria != nullptr) names = read_listed(*criteria, judgments != nullptr, faults, found, read);
  if (names.empty() && found.size() == before) faults.add("criteria", "is empty", R"(write {"battery": 1})");
  if (found.size() != before) return;
  judgments != nullptr ? read_judgments(*judgments, names, faults, read) : read_weights(faults, read);
  if (found.size() == before) out.criteria = std::move(read);
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
  static const Criteria kCriteria = [] {
    const std::vector<std::string> names = {"battery", "distance", "availability"};
    Criteria out = paper_criteria();
    set_weights(names, weigh_criteria(names, kFigure8)->weights, out);
    return out;
  }();
  ResilienceSettings out;
  out.criteria = kCriteria;
  return out;
}

ResilienceSettings read_resilience(const Value& json, const std::string& file, ConfigFaults& faults) {
  ResilienceSettings out = default_resilience();
  const FileFaults sink(file, faults);
  ObjectReader reader(json, "", sink);
  const Value* criteria = reader.value("criteria", Need::optional);
  const Value::List* judgments = reader.list("judgments", Need::optional, kMaxPairs);
  if (criteria != nullptr || judgments != nullptr) read_criteria(criteria, judgments, sink, faults, out);
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
