// The middleware's own services, a row each: on which nodes they run. Their programs are trb-NAME.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "proto/bodies/signed.hpp"

namespace trb {

enum class Runs : unsigned char {
  never = 0,
  if_named,  ///< in "services" of node.json
  always,    ///< also where node.json names none
};

struct ServiceRow {
  std::string_view name;
  Runs robot{};  ///< on a robot's node
  Runs cloud{};
};

std::span<const ServiceRow> service_rows();

/// What a node of that role may run.
std::vector<std::string> services_of(Role role);

/// What it runs if node.json names nothing else.
std::vector<std::string> default_services_of(Role role);

/// A name of the middleware's own services, of its future ones, or of other members of a bus ("probe", "tap"): an
/// operator's service must not have it.
bool is_reserved_service(std::string_view name);

}  // namespace trb
