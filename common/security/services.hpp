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

/// What it runs if nothing else is said.
std::vector<std::string> default_services_of(Role role);

/// A name of the middleware's own services, of those that are still to come, or of what else stands on a bus ("probe",
/// "tap"): no operator's service bears it.
bool is_reserved_service(std::string_view name);

}  // namespace trb
