// Whether what a skill may send has the items that its command takes: known from the files, before a run fails at it.
#pragma once

#include "common/config/node_config.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb::drivers {

/// How a transport fills {0}, {1} … of a command.
enum class Items : std::uint8_t {
  any = 0,  ///< also of a single word or number
  list,     ///< of a list that has them, perhaps more
  exact     ///< of a list with just as many
};

/// Faults of the command of a skill that hands over one parameter as a whole: a place that the parameter names (one_of,
/// default), or a list of numbers whose "count" is another one.
void check_place_items(const NodeConfig& config, const Skill& skill, Items items, const FileFaults& faults);

}  // namespace trb::drivers
