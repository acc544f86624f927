// Goes through what a new robot must do: it is there, connected, free, tells its state and its position, each skill
// that a person lets it try, stop, release. For what fails: what to put right, and in which file.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/operator/session.hpp"
#include "proto/bodies/link.hpp"
#include "proto/value.hpp"

namespace trb::op {

enum class TryState : unsigned char {
  good,
  failed,
  skipped,
  unproved  ///< nothing speaks against it, but the robot need not have understood it
};

struct TryStep {
  std::string name;  ///< "connected", "stop", "skill pick" ...
  TryState state{};
  std::string text;  ///< what was seen, or why not
  std::string cure;  ///< of a failed one: what to put right, with the file and the key
};

/// How a person takes part. An answer may come at once or later.
struct TryPerson {
  /// May the robot try this skill now? It may move. Asked before each skill, without exception.
  std::function<void(const SkillInfo& skill, std::function<void(bool yes)> answer)> may_try;
  /// A parameter's value; nothing: the person gives none. `choices`: the words that it may have; empty: any.
  std::function<void(const SkillInfo& skill, const ParameterInfo& parameter, const std::vector<std::string>& choices,
                     std::function<void(std::optional<std::string> word)> answer)>
      value_of;
  std::function<void(const TryStep& step)> see;
};

struct TryWish {
  std::string robot;
  TryPerson person;
  std::vector<std::string> skills{};             ///< that a person has named; only these are asked for. Empty: all
  std::vector<std::string> parameters{};         ///< "skill.parameter", whose values a person has given
  bool must = false;                             ///< the named skills are to be tried: one that was not has failed
  Duration connects = std::chrono::seconds(10);  ///< how long it may take until the robot is there and connected
};

/// `done` gets every step, in order. A robot that is not there, not connected or not free is not tried any further; one
/// whose skill has failed is still stopped and released. Errors: those of the routing table; bad_value (a skill or
/// parameter of the wish that the robot does not have; nothing is tried then).
void try_robot(Session& session, TryWish wish, Callback<std::vector<TryStep>> done);

/// A parameter's value from a person's word. Errors: bad_value, naming skill and parameter.
Result<Value> parameter_value(const SkillInfo& skill, const ParameterInfo& parameter, const std::string& word);

}  // namespace trb::op
