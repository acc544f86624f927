#include "services/mode-adapter/core/fault_rules.hpp"

#include <algorithm>

#include "services/mode-adapter/core/same_number.hpp"

namespace trb::adapter {
namespace {

constexpr Duration kQuiet = std::chrono::seconds(10);
constexpr std::size_t kMaxOwnText = 600;

enum class Judgment : std::uint8_t { met, neither, over };

/// The value as text; nothing for a number, a list and the like.
std::optional<std::string> words_of(const RobotValue& value) {
  const auto json = parse_json(value.json);
  if (!json || !json->is_text()) return std::nullopt;
  return cut_utf8(json->text(), kMaxOwnText);
}

/// Of several numbers one is enough to begin; for the end all have to be back.
Judgment judge_limit(const FaultRule& rule, const std::vector<double>& numbers) {
  const bool below = rule.when == FaultWhen::below;
  const auto met = [&](double number) { return below ? number < rule.limit : number > rule.limit; };
  const auto back = [&](double number) { return below ? number >= rule.rearm : number <= rule.rearm; };
  if (std::any_of(numbers.begin(), numbers.end(), met)) return Judgment::met;
  return !numbers.empty() && std::all_of(numbers.begin(), numbers.end(), back) ? Judgment::over : Judgment::neither;
}

bool equals(const Value& wanted, const RobotValue& value) {
  if (wanted.is_text()) return words_of(value) == wanted.text();
  const double number = wanted.is_bool() ? double(wanted.boolean()) : wanted.number();
  return std::any_of(value.numbers.begin(), value.numbers.end(), [&](double one) { return same_number(one, number); });
}

bool is_nothing(const std::string& json) {
  return json.empty() || json == "\"\"" || json == "0" || json == "false" || json == "null" || json == "[]";
}

std::string cause_of(const FaultRule& rule) {
  return "rule " + rule.name;
}

FaultSaid said(const FaultRule& rule, const RobotValue& value) {
  const std::string own = words_of(value).value_or(rule.value + " is " + cut_utf8(value.json, kMaxOwnText));
  return {rule.capability, rule.severity, rule.text.empty() ? own : rule.text + ": " + own, cause_of(rule)};
}

}  // namespace

FaultRules::FaultRules(const std::vector<FaultRule>& rules) {
  for (const FaultRule& rule : rules) watched_.push_back({&rule, false, {}, {}, {}, {}});
}

void FaultRules::on_value(std::string_view name, const RobotValue& value, Now now, FaultChanges& changes) {
  for (Watched& watched : watched_) {
    const FaultRule& rule = *watched.rule;
    if (rule.value != name) continue;
    if (rule.when == FaultWhen::changes) {
      on_change(watched, value, now, changes);
      continue;
    }
    const Judgment judgment = rule.when == FaultWhen::equals
                                  ? (equals(rule.wanted, value) ? Judgment::met : Judgment::over)
                                  : judge_limit(rule, value.numbers);
    if (judgment == Judgment::met) watched.stands = said(rule, value);
    if (judgment == Judgment::met && !watched.begun) begin(watched, value, now, changes);
    if (judgment == Judgment::over) {
      watched.stands.reset();
      watched.begun = false;
      watched.waits.reset();
      changes.over.push_back({cause_of(rule)});
    }
  }
}

void FaultRules::on_change(Watched& watched, const RobotValue& value, Now now, FaultChanges& changes) {
  const bool first = !watched.last;
  const bool changed = !first && *watched.last != value.json;
  watched.last = value.json;
  watched.stands.reset();
  if (is_nothing(value.json)) {
    watched.waits.reset();
    return changes.over.push_back({cause_of(*watched.rule)});
  }
  watched.stands = said(*watched.rule, value);
  if (changed) return begin(watched, value, now, changes);
  if (!first) return;
  changes.said.push_back(*watched.stands);
  changes.said.back().is_new = false;
}

void FaultRules::begin(Watched& watched, const RobotValue& value, Now now, FaultChanges& changes) {
  watched.begun = true;
  watched.waits = said(*watched.rule, value);
  if (!watched.quiet_until || now.mono >= *watched.quiet_until) watched.quiet_until = now.mono;
  tick(now, changes);
}

void FaultRules::tick(Now now, FaultChanges& changes) {
  for (Watched& watched : watched_) {
    if (!watched.waits || now.mono < *watched.quiet_until) continue;
    changes.said.push_back(std::move(*watched.waits));
    watched.waits.reset();
    watched.quiet_until = now.mono + kQuiet;
  }
}

std::optional<MonotonicTime> FaultRules::next_deadline() const {
  std::optional<MonotonicTime> next;
  for (const Watched& watched : watched_) {
    if (watched.waits) next = earlier(next, watched.quiet_until);
  }
  return next;
}

const FaultSaid* FaultRules::standing(std::string_view capability) const {
  for (const Watched& watched : watched_) {
    const auto& stands = watched.stands;
    if (!stands || stands->severity < Severity::critical) continue;
    if (capability.empty() || stands->capability.empty() || stands->capability == capability) return &*stands;
  }
  return nullptr;
}

void FaultRules::forget_standing() {
  for (Watched& watched : watched_) watched.stands.reset();
}

void FaultRules::begin_again(std::string_view capability) {
  for (Watched& watched : watched_) {
    if (!capability.empty() && watched.rule->capability != capability) continue;
    watched.begun = false;
    watched.last.reset();
  }
}

}  // namespace trb::adapter
