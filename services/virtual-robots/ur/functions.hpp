#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "services/virtual-robots/ur/packets.hpp"
#include "services/virtual-robots/ur/program.hpp"
#include "services/virtual-robots/ur/registers.hpp"
#include "services/virtual-robots/ur/shape.hpp"

namespace trb::virtual_robots::ur {

/** What a running program can ask for. */
struct World {
  RobotState state;
  Registers inputs;
  Registers outputs;
};

/** Ends a program with this text. */
struct ScriptFault {
  std::string text;
};

/** The seconds of one round of the controller. */
inline constexpr double kStepTime = 0.002;

/** A parameter takes values of its kind; `Six` is a list of six numbers, `Target` six joints or a pose. */
struct Parameter {
  enum class Kind { number, positive, boolean, text, target, six, pose, list, any };
  std::string_view name;
  Kind kind;
  bool required = false;
};

/** The values of a call by parameter. */
using Bound = std::vector<std::optional<Value>>;

/** A function of the controller's: it does something, or it tells something. */
struct Function {
  std::string_view name;
  std::vector<Parameter> parameters;
  Step (*make)(const std::string& function, const Bound& bound) = nullptr;
  Value (*tell)(const World& world, const Bound& bound) = nullptr;
  Shape::Kind gives = Shape::Kind::none;
  bool takes_time = false;
};

/** Nothing: there is no such function. */
const Function* function_of(std::string_view name);

/** Those that do something; those that tell the robot's state or reckon. */
const std::vector<Function>& doing_functions();
const std::vector<Function>& telling_functions();
const std::vector<Function>& reckoning_functions();

/** Whether a parameter takes the value; of what is not known yet: perhaps. */
bool fits(Parameter::Kind kind, const Shape& shape);
/** False: the value is a list, but not of six numbers as it has to be. */
bool counts(Parameter::Kind kind, const Shape& shape);

/** A value as textmsg shows it. */
std::string show(const Value& value);

}  // namespace trb::virtual_robots::ur
