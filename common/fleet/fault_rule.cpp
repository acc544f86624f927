#include <algorithm>
#include <cmath>

#include "common/base/ids.hpp"
#include "common/fleet/description_parts.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "proto/value_words.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxFaults = 32;
constexpr std::size_t kMaxSensors = 32;
constexpr std::size_t kMaxFaultText = 255;
/// How far, as a fraction of the limit, a value must come back by default.
constexpr double kReturn = 0.05;
constexpr const char* kConditions = R"(give one of "below", "above", "equals" and "changes")";

bool holds(ObjectReader& reader, FaultWhen when) {
  return reader.value(name_of(when), Need::optional) != nullptr;
}

void read_limit(ObjectReader& reader, FaultRule& rule) {
  const bool below = rule.when == FaultWhen::below;
  rule.limit = reader.number(name_of(rule.when), Need::required).value_or(0);
  const double way = kReturn * std::abs(rule.limit);
  rule.rearm = reader.number("rearm", Need::optional).value_or(below ? rule.limit + way : rule.limit - way);
  if (below ? rule.rearm >= rule.limit : rule.rearm <= rule.limit) return;
  reader.faults().add(reader.path("rearm"), "lies where the fault itself is",
                      below ? R"(make it at least as large as "below")" : R"(make it at most as large as "above")");
}

void read_wanted(ObjectReader& reader, FaultRule& rule) {
  const Value& wanted = *reader.value("equals", Need::required);
  if (wanted.is_number() || wanted.is_text() || wanted.is_bool()) {
    rule.wanted = wanted;
  } else {
    reader.faults().add(reader.path("equals"), "is " + in_words(wanted), "write a number, a text, true or false");
  }
}

void read_changes(ObjectReader& reader) {
  if (reader.boolean("changes", Need::required).value_or(true)) return;
  reader.faults().add(reader.path("changes"), "is false, so this fault is never told", "write true");
}

void read_condition(ObjectReader& reader, FaultRule& rule) {
  std::vector<FaultWhen> given;
  for (const FaultWhen when : {FaultWhen::below, FaultWhen::above, FaultWhen::equals, FaultWhen::changes}) {
    if (holds(reader, when)) given.push_back(when);
  }
  if (given.size() != 1) {
    reader.value("rearm", Need::optional);  // whatever else is wrong with it: one mistake, one fault
    return reader.faults().add("faults." + rule.name,
                               given.empty() ? "has no condition" : "has more than one condition", kConditions);
  }
  rule.when = given[0];
  if (rule.when == FaultWhen::below || rule.when == FaultWhen::above) return read_limit(reader, rule);
  if (rule.when == FaultWhen::equals) return read_wanted(reader, rule);
  read_changes(reader);
}

FaultRule read_fault(const std::string& name, const Value& json, const std::vector<std::string>& capabilities,
                     const FileFaults& faults) {
  const std::string path = "faults." + name;
  ObjectReader reader(json, path, faults);
  FaultRule rule;
  rule.name = name;
  if (!is_valid_word(name)) {
    faults.add(path, in_quotes(name) + " is no name", "start with a letter; then letters, digits, '_' or '-'");
  }
  rule.value = reader.text("value", Need::required, kMaxIdSize).value_or("");
  if (reader.is_object()) read_condition(reader, rule);
  rule.severity = reader.one_of<Severity>("severity", Need::required).value_or(Severity::warning);
  rule.capability = reader.text("capability", Need::optional, kMaxIdSize).value_or("");
  rule.text = reader.text("text", Need::optional, kMaxFaultText).value_or("");
  reader.refuse_unknown_keys();
  const bool known = std::find(capabilities.begin(), capabilities.end(), rule.capability) != capabilities.end();
  if (!rule.capability.empty() && !known) {
    faults.add(reader.path("capability"), in_quotes(rule.capability) + " is not among the robot's capabilities",
               did_you_mean(rule.capability, capabilities, "leave it out for all of them, or use one of"));
  }
  return rule;
}

}  // namespace

std::vector<FaultRule> read_faults(ObjectReader& reader, const std::vector<std::string>& capabilities) {
  std::vector<FaultRule> rules;
  const auto* members = reader.object("faults", Need::optional, kMaxFaults);
  if (members == nullptr) return rules;
  for (const auto& [name, json] : *members) rules.push_back(read_fault(name, json, capabilities, reader.faults()));
  return rules;
}

std::vector<std::string> read_sensors(ObjectReader& reader) {
  std::vector<std::string> sensors = reader.texts("sensors", Need::optional, kMaxSensors);
  for (const std::string& name : sensors) {
    if (is_valid_word(name)) continue;
    reader.faults().add("sensors", in_quotes(name) + " is no value's name",
                        "start with a letter; then letters, digits, '_' or '-'");
  }
  return sensors;
}

}  // namespace trb
