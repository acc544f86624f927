#include <algorithm>

#include "common/base/ids.hpp"
#include "common/fleet/description_parts.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/fleet/placeholders.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxData = 4096;
const char* const kWhatAnEndIs =
    R"(say how it is known that the skill has ended: {"kind": "acknowledgement"} if the robot reports it, )"
    R"({"kind": "state", "state": NAME, "equals": NUMBER}, {"kind": "position", "target": PARAMETER, )"
    R"("tolerance": NUMBER} or {"kind": "time", "duration_s": SECONDS})";

const Parameter* find_parameter(const Skill& skill, std::string_view name) {
  const auto at = std::find_if(skill.parameters.begin(), skill.parameters.end(),
                               [&](const Parameter& parameter) { return parameter.name == name; });
  return at == skill.parameters.end() ? nullptr : &*at;
}

std::vector<std::string> parameter_names(const Skill& skill) {
  std::vector<std::string> names;
  for (const Parameter& parameter : skill.parameters) names.push_back(parameter.name);
  return names;
}

bool is_coordinate(std::string_view text) {
  return text == "x" || text == "y" || text == "z" || text == "yaw" || text == "qz" || text == "qw";
}

void check_placeholder(const Skill& skill, const Placeholder& placeholder, const std::string& path,
                       const FileFaults& faults) {
  const Parameter* parameter = find_parameter(skill, placeholder.name);
  if (parameter == nullptr) {
    faults.add(path, "{" + placeholder.name + "} names no parameter of the skill",
               did_you_mean(placeholder.name, parameter_names(skill), "add it to \"parameters\", or use one of"));
  } else if (!placeholder.coordinate.empty() && parameter->type != ParameterType::place) {
    faults.add(path, in_quotes(placeholder.name) + " is no place and has no coordinates",
               "use {" + placeholder.name + "}");
  } else if (!placeholder.coordinate.empty() && !is_coordinate(placeholder.coordinate)) {
    faults.add(path, in_quotes(placeholder.coordinate) + " is no coordinate", "use one of: x, y, z, yaw, qz, qw");
  } else if (!parameter->required && !parameter->preset) {
    faults.add(path, "{" + placeholder.name + "} may be left out and has no default",
               "give the parameter a \"default\", or make it required");
  }
}

void read_command(ObjectReader& reader, Skill& skill) {
  skill.subtype = skill.name;
  const Value* json = reader.value("command", Need::optional);
  if (json == nullptr) return;
  ObjectReader command(*json, reader.path("command"), reader.faults());
  skill.subtype = command.text("subtype", Need::optional, kMaxIdSize).value_or(skill.name);
  skill.data = command.text("data", Need::optional, kMaxData).value_or("");
  command.refuse_unknown_keys();
  if (!is_valid_word(skill.subtype)) {
    reader.faults().add(command.path("subtype"), in_quotes(skill.subtype) + " is no subtype",
                        "start with a letter; then letters, digits, '_' or '-'");
  }
  const Template data = parse_template(skill.data);
  if (!data.well_formed) {
    reader.faults().add(command.path("data"), "has a bracket that is no placeholder", "use {NAME} or {NAME.x}");
  }
  for (const Placeholder& placeholder : data.placeholders) {
    if (is_valid_word(placeholder.name)) check_placeholder(skill, placeholder, command.path("data"), reader.faults());
  }
}

void check_reserved(const Skill& skill, const std::string& path, const FileFaults& faults) {
  if (skill.subtype != "stop" && skill.subtype != "release") return;
  faults.add(path, in_quotes(skill.subtype) + " is no skill: every robot has it, and it overtakes all else",
             "remove the skill, or give its command another subtype");
}

void read_target(ObjectReader& reader, const Skill& skill, SkillEnd& end) {
  end.target = reader.text("target", Need::required, kMaxIdSize).value_or("");
  end.state = reader.text("value", Need::optional, kMaxIdSize).value_or("");
  end.tolerance = reader.number("tolerance", Need::optional, {0, 1e6, true}).value_or(end.tolerance);
  if (end.target.empty()) return;
  const Parameter* parameter = find_parameter(skill, end.target);
  if (parameter == nullptr) {
    reader.faults().add(reader.path("target"), in_quotes(end.target) + " names no parameter of the skill",
                        did_you_mean(end.target, parameter_names(skill), "use one of"));
  } else if (parameter->type != ParameterType::place && parameter->type != ParameterType::numbers) {
    reader.faults().add(reader.path("target"), in_quotes(end.target) + " is no position",
                        "name a parameter of type place or numbers");
  }
}

void read_duration(ObjectReader& reader, const Skill& skill, SkillEnd& end) {
  end.duration_s = reader.number("duration_s", Need::required, kSeconds).value_or(0);
  if (end.duration_s < skill.timeout_s) return;
  reader.faults().add(reader.path("duration_s"), "the skill would time out before it ends",
                      "make \"timeout_s\" longer than \"duration_s\"");
}

void read_end(ObjectReader& skill_reader, Skill& skill) {
  const Value* json = skill_reader.value("end", Need::optional);
  if (json == nullptr) {
    return skill_reader.faults().add(skill_reader.path("end"), "the skill has no end", kWhatAnEndIs);
  }
  ObjectReader reader(*json, skill_reader.path("end"), skill_reader.faults());
  const auto kind = reader.one_of<EndKind>("kind", Need::required);
  if (!kind) return;
  skill.end.kind = *kind;
  if (*kind == EndKind::state) {
    skill.end.state = reader.text("state", Need::required, kMaxIdSize).value_or("");
    skill.end.equals = reader.number("equals", Need::required).value_or(0);
    skill.end.fails_at = reader.number("fails_at", Need::optional);
    if (skill.end.fails_at == skill.end.equals) {
      reader.faults().add(reader.path("fails_at"), "is \"equals\" again", "give the value that means that it failed");
    }
  }
  if (*kind == EndKind::position) read_target(reader, skill, skill.end);
  if (*kind == EndKind::time) read_duration(reader, skill, skill.end);
  reader.refuse_unknown_keys();
}

}  // namespace

std::string read_capability(ObjectReader& reader, const std::vector<std::string>& capabilities) {
  std::string capability = reader.text("capability", Need::required, kMaxIdSize).value_or("");
  if (capability.empty() || std::find(capabilities.begin(), capabilities.end(), capability) != capabilities.end()) {
    return capability;
  }
  reader.faults().add(reader.path("capability"), in_quotes(capability) + " is not among the robot's capabilities",
                      did_you_mean(capability, capabilities, "add it to \"capabilities\", or use one of"));
  return capability;
}

Skill read_skill(const std::string& name, const Value& json, const std::vector<std::string>& capabilities,
                 const FileFaults& faults) {
  ObjectReader reader(json, "skills." + name, faults);
  Skill skill;
  skill.name = name;
  if (!is_valid_word(name)) {
    faults.add("skills." + name, in_quotes(name) + " is no name",
               "start with a letter; then letters, digits, '_' or '-'");
  }
  skill.capability = read_capability(reader, capabilities);
  if (const auto* parameters = reader.object("parameters", Need::optional, kMaxParameters)) {
    for (const auto& [key, member] : *parameters) {
      skill.parameters.push_back(read_parameter(key, member, reader.path("parameters") + "." + key, faults));
    }
  }
  skill.timeout_s = reader.number("timeout_s", Need::optional, kSeconds).value_or(skill.timeout_s);
  skill.repeatable = reader.boolean("repeatable", Need::optional).value_or(false);
  read_command(reader, skill);
  check_reserved(skill, "skills." + name, faults);
  if (reader.is_object()) read_end(reader, skill);
  reader.refuse_unknown_keys();
  return skill;
}

}  // namespace trb
