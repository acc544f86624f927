#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trb::virtual_robots::kuka {

enum class Type { bool_, int_, real, text, axis, pos, enum_ };

/** A structure's components in KRL's order: A1 … A6, or X Y Z A B C S T, then E1 … E6. */
const std::vector<std::string>& components_of(Type type);

/** The variables of a controller, with their types, read and written as text, as on the controller. */
class Variables {
 public:
  /** A stored variable. A structure's value names what is not 0. `room`: of a text, in characters. */
  void declare(const std::string& name, Type type, const std::string& value, std::size_t room = 0);
  /** A read-only variable: `value` gives its present value. */
  void declare_live(const std::string& name, std::function<std::string()> value);

  /** The value as the controller prints it; nothing: no such variable. Case does not matter. */
  std::optional<std::string> read(std::string_view name) const;
  /** False: no such variable, wrong type, read-only, or too long. */
  bool write(std::string_view name, std::string_view value);

  // For the program on the robot, which uses its own variables.
  bool flag(const std::string& name) const { return text(name) == "TRUE"; }
  long long number(const std::string& name) const;
  /** A stored value; a text without its quotes. */
  std::string text(const std::string& name) const;
  /** A structure's components. */
  std::vector<double> numbers(const std::string& name) const;
  void set(const std::string& name, const std::string& value);
  std::size_t room(const std::string& name) const;

 private:
  struct Variable {
    Type type{};
    std::string value;          ///< of a text without its quotes
    std::vector<double> parts;  ///< of a structure
    std::size_t room = 0;
    std::function<std::string()> live;
  };
  /** The stored name of the variable; empty: there is none. */
  std::string key_of(std::string_view name, std::string& component) const;

  std::map<std::string, Variable> variables_;
};

/** "{E6AXIS: A1 0.0, ...}". */
std::string structure_text(Type type, const std::vector<double>& parts);

}  // namespace trb::virtual_robots::kuka
