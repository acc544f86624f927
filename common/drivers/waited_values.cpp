#include "common/drivers/waited_values.hpp"

#include "common/drivers/text/number_text.hpp"

namespace trb::drivers {

std::vector<WaitedValue> waited_values(const NodeConfig& config) {
  std::vector<WaitedValue> out;
  const auto& requests = config.commands.requests;
  const auto add = [&](const std::string& name, const Value& wanted, const std::string& by) {
    const auto request = requests.find(name);
    out.push_back({request == requests.end() ? name : request->second, wanted, by});
  };
  for (const FaultRule& rule : config.description.faults) {
    if (rule.when == FaultWhen::equals) add(rule.value, rule.wanted, "faults." + rule.name + ".equals");
  }
  for (const Skill& skill : config.description.skills) {
    if (skill.end.kind != EndKind::state) continue;
    const std::string end = "skills." + skill.name + ".end.";
    add(skill.end.state, Value{skill.end.equals}, end + "equals");
    if (skill.end.fails_at) add(skill.end.state, Value{*skill.end.fails_at}, end + "fails_at");
  }
  return out;
}

std::string text_of_wanted(const Value& wanted) {
  return wanted.is_number() ? number_text(wanted.number()) : dump_json(wanted);
}

}  // namespace trb::drivers
