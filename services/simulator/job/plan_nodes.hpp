// The nodes of a planned world, by their ids.
#pragma once

#include <string>

#include "common/fleet/object_reader.hpp"
#include "services/simulator/world/world.hpp"

namespace trb::simulator {

constexpr std::size_t kMaxId = 64;
constexpr const char* kCloud = "cloud";

[[nodiscard]] bool is_node(const world::WorldPlan& plan, const std::string& id);

/// A fault, by `key` of the reader, if there is no such node.
void check_node(const ObjectReader& reader, const world::WorldPlan& plan, const char* key, const std::string& id);

}  // namespace trb::simulator
