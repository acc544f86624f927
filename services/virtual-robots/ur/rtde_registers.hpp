#pragma once

#include "services/virtual-robots/ur/rtde_values.hpp"

namespace trb::virtual_robots::ur {

/** `bit_registers0_to_31`, `bit_register_64`, `int_register_0`, `double_register_0`, behind `input_` or `output_`. */
struct RegisterName {
  enum class Kind { word, bit, integer, double_ };
  Kind kind;
  int index;
};
std::optional<RegisterName> register_name(std::string_view name, std::string_view prefix);

}  // namespace trb::virtual_robots::ur
