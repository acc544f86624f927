#include "common/drivers/polled_values.hpp"

#include <utility>

namespace trb::drivers {
namespace {

/// "3 values (battery, position, state)"
std::string named(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 3;
  std::string out = std::to_string(names.size()) + " values (";
  for (std::size_t i = 0; i < names.size() && i < kMost; ++i) out += (i == 0 ? "" : ", ") + names[i];
  return out + (names.size() > kMost ? ", ...)" : ")");
}

}  // namespace

std::vector<std::string> needed_values(const VendorCommands& vendor, const Description& description) {
  std::vector<std::string> out;
  const auto add = [&](const std::string& name) {
    const auto request = vendor.requests.find(name);
    out.push_back(request == vendor.requests.end() ? name : request->second);
  };
  for (const auto& [subtype, name] : vendor.requests) add(subtype);
  for (const FaultRule& rule : description.faults) add(rule.value);
  for (const std::string& name : description.sensors) add(name);
  for (const Skill& skill : description.skills) {
    if (skill.end.kind != EndKind::state && skill.end.kind != EndKind::position) continue;
    add(skill.end.state.empty() ? "position" : skill.end.state);
  }
  return out;
}

double hold_s(const VendorCommands& vendor) {
  const auto given = vendor.numbers.find("hold_s");
  return given == vendor.numbers.end() ? kHold_s : given->second;
}

void PolledValues::Changes::report(const DriverOut& out) const {
  std::map<std::string, std::vector<std::string>> alike;  // by what they share
  for (const Problem& one : problems) {
    if (!one.shared.empty()) alike[one.shared].push_back(one.name);
  }
  for (const Problem& one : problems) {
    const auto names = alike.find(one.shared);
    const bool is_one_of_many = names != alike.end() && names->second.size() > 1;
    if (is_one_of_many && names->second.front() != one.name) continue;
    const std::string what = is_one_of_many ? named(names->second) + ": " + one.shared : one.why.what;
    out.emit(FaultSaid{"", Severity::warning, what + "; " + one.why.hint});
  }
  if (values) out.emit(ValuesHeard{});
}

const RobotValue* PolledValues::value(std::string_view name) const {
  const auto known = known_.find(name);
  return known == known_.end() || !known->second.value ? nullptr : &*known->second.value;
}

std::optional<Error> PolledValues::problem(std::string_view name) const {
  const auto known = known_.find(name);
  return known == known_.end() ? std::nullopt : known->second.problem;
}

void PolledValues::keep(const std::string& name, RobotValue value, Changes& changes) {
  known_[name] = {std::move(value), {}, true};
  changes.values = true;
}

void PolledValues::lose(const std::string& name, const Error& problem, Changes& changes, const std::string& shared) {
  Known& known = known_[name];
  const bool is_new = !known.problem || !known.told || known.problem->what != problem.what;
  known = {{}, problem, true};
  if (is_new) changes.problems.push_back({name, problem, shared});
}

void PolledValues::drop_values() {
  for (auto& [name, known] : known_) known.value.reset();
}

}  // namespace trb::drivers
