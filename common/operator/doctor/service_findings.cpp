#include "common/operator/doctor/service_findings.hpp"

#include <algorithm>

#include "common/fleet/did_you_mean.hpp"
#include "common/operator/doctor/machine_findings.hpp"
#include "common/security/services.hpp"

namespace trb::op {
namespace {

void add_state(const Observed& seen, const std::string& service, std::vector<Finding>& out) {
  const auto entry = std::ranges::find(seen.services.services, service, &ServiceEntry::service);
  if (entry == seen.services.services.end()) {
    out.push_back({Weight::problem, "service_down", service, "the router's node.json does not name this service",
                   "add it to \"services\" there, and restart the router"});
    return;
  }
  if (entry->state != "up") {
    out.push_back({Weight::problem, "service_down", service, "the router finds the service " + entry->state,
                   "see the log of its container; restart it"});
  }
  if (entry->note.starts_with(kWaitsNote)) {
    out.push_back({Weight::problem, "service_waits", service, entry->note, std::string(kWaitsHint)});
  } else if (!entry->note.empty()) {
    out.push_back({Weight::note, "service_note", service, entry->note, "see trb service list"});
  }
}

void add_answer(const Observed& seen, const std::string& service, std::vector<Finding>& out) {
  if (seen.answers) return add_state(seen, service, out);
  if (seen.bus_key_refused) {
    const std::string key = "keys/bus/" + service + ".key";
    out.push_back({Weight::problem, "bus_key", key, "the router's bus does not take this key of the service",
                   "copy " + key + " from where it was made, or its .pub to where the router runs"});
    return;
  }
  out.push_back({Weight::problem, "router_down", seen.node, "its router does not answer on the bus",
                 "start the router; look for a firewall between here and its machine"});
}

/// A service that is none has no key either, and would seem to have no router.
void add_unnamed(const Observed& seen, const std::string& service, std::vector<Finding>& out) {
  out.push_back({Weight::problem, "service_down", service, "node.json names no such service",
                 did_you_mean(service, seen.named, "add it to \"services\" there, or name one of")});
}

}  // namespace

void add_missing_adapter(const Observed& seen, std::vector<Finding>& out) {
  const std::string adapter = "mode-adapter";
  if (!seen.has_robot || seen.named.empty() || std::ranges::find(seen.named, adapter) != seen.named.end()) return;
  const auto self = std::ranges::find(seen.routes.routes, seen.node, &Route::id);
  const bool is_heard = self != seen.routes.routes.end() && !self->profile.robot.empty();
  const auto& services = seen.services.services;
  if (is_heard || std::ranges::find(services, adapter, &ServiceEntry::service) != services.end()) return;
  const bool may_be_own = !std::ranges::all_of(seen.named, is_reserved_service);
  out.push_back({may_be_own ? Weight::note : Weight::problem, "service_down", adapter, std::string(kNoModeAdapter),
                 std::string(kAddModeAdapter)});
}

Finding finding_of(const ConfigFault& fault) {
  const std::string key = fault.key.empty() ? "" : fault.key + ": ";
  const bool ended = fault.key == "not_after";
  return {Weight::problem, ended ? "cert_expired" : "node_folder", fault.file, key + fault.what, fault.hint};
}

std::vector<Finding> diagnose_service(const Observed& seen, const std::string& service) {
  std::vector<Finding> out;
  for (const ConfigFault& fault : seen.faults) out.push_back(finding_of(fault));
  add_machine_findings(seen, out);
  const bool is_named = seen.named.empty() || std::ranges::find(seen.named, service) != seen.named.end();
  is_named ? add_answer(seen, service, out) : add_unnamed(seen, service, out);
  std::ranges::stable_sort(out, std::ranges::greater(), &Finding::weight);
  return out;
}

}  // namespace trb::op
