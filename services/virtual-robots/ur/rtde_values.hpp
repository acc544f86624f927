#pragma once

#include <optional>
#include <string_view>

#include "services/virtual-robots/ur/bytes.hpp"
#include "services/virtual-robots/ur/controller.hpp"
#include "services/virtual-robots/ur/reader.hpp"

namespace trb::virtual_robots::ur {

/** Names and types of the variables are those of the maker's RTDE guide. */
enum class RtdeType { vector6d, vector3d, vector6_int32, vector6_uint32, double_, uint64, uint32, int32, bool_, uint8 };
std::string_view name_of(RtdeType type);
/** In bytes. */
std::size_t size_of(RtdeType type);

/** What the outputs are taken from. */
struct RtdePicture {
  RobotState state;
  double time = 0;  ///< of the robot, in seconds
  Registers inputs;
  Registers outputs;
};

struct RtdeOutput {
  RtdeType type;
  void (*put)(const RtdePicture& picture, int index, Bytes& out);
  int index = 0;  ///< of a register
};
std::optional<RtdeOutput> rtde_output(std::string_view name);

/** What a client has written; a mask says which of the values beside it count. */
struct RtdeWritten {
  std::uint32_t slider_mask = 0;
  double slider = 1;
  std::uint8_t standard_mask = 0, standard = 0;
  std::uint8_t configurable_mask = 0, configurable = 0;
  std::uint8_t tool_mask = 0, tool = 0;
  std::uint8_t analog_mask = 0, analog_type = 0;
  std::array<double, 2> analog{};
  Registers registers;
};

struct RtdeInput {
  RtdeType type;
  void (*take)(Reader& in, int index, RtdeWritten& into);
  int index = 0;
};
std::optional<RtdeInput> rtde_input(std::string_view name);

/** Lets the controller have what was written. */
void apply(const RtdeWritten& written, Controller& controller, double now);

}  // namespace trb::virtual_robots::ur
