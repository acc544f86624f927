#include "common/drivers/polled_values.hpp"

#include <utility>

namespace trb::drivers {

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

void PolledValues::Changes::report(const DriverOut& out) const {
  for (const Error& problem : problems) {
    out.emit(FaultSaid{"", Severity::warning, problem.what + "; " + problem.hint});
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
  known_[name] = {std::move(value), {}};
  changes.values = true;
}

void PolledValues::lose(const std::string& name, const Error& problem, Changes& changes) {
  Known& known = known_[name];
  const bool is_new = !known.problem || known.problem->what != problem.what;
  known = {{}, problem};
  if (is_new) changes.problems.push_back(problem);
}

void PolledValues::drop_values() {
  for (auto& [name, known] : known_) known.value.reset();
}

}  // namespace trb::drivers
