#include "common/security/services.hpp"

#include <algorithm>

#include "proto/travel.hpp"

namespace trb {
namespace {

// A name is reserved so that an operator's service of today never gets the rights of a future one, which runs nowhere
// yet.
constexpr ServiceRow kServices[] = {
    {"router", Runs::always, Runs::always},         {"mode-adapter", Runs::always, Runs::never},
    {"scheduler", Runs::always, Runs::always},      {"ros-bridge", Runs::if_named, Runs::never},
    {"sensor-bus", Runs::if_named, Runs::if_named}, {"resilience", Runs::if_named, Runs::if_named},
    {"cloud-gateway", Runs::never, Runs::if_named}, {"simulator", Runs::never, Runs::never},
};
constexpr std::string_view kOnNoNode[] = {kProbe, "tap"};

std::vector<std::string> names(Role role, Runs least) {
  std::vector<std::string> out;
  for (const ServiceRow& row : kServices) {
    if ((role == Role::cloud ? row.cloud : row.robot) >= least) out.emplace_back(row.name);
  }
  return out;
}

}  // namespace

std::span<const ServiceRow> service_rows() {
  return kServices;
}

std::vector<std::string> services_of(Role role) {
  return names(role, Runs::if_named);
}

std::vector<std::string> default_services_of(Role role) {
  return names(role, Runs::always);
}

bool is_reserved_service(std::string_view name) {
  return std::ranges::find(kServices, name, &ServiceRow::name) != std::end(kServices) ||
         std::ranges::find(kOnNoNode, name) != std::end(kOnNoNode);
}

}  // namespace trb
