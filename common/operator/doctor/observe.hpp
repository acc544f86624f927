// What the doctor asks a node's router and the routers linked to it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/operator/doctor/diagnosis.hpp"
#include "common/operator/session.hpp"

namespace trb::op {

/// Called after the doctor's requests: with the earlier observations and what the answers added.
using ObservedNext = std::function<void(Observed)>;

/// Asks the own router for its table, its services and its link errors, and its scheduler for its runs and counters.
/// What is not answered stays empty.
void observe_router(Session& session, Observed seen, const ObservedNext& next);

/// Sends echoes, small and large, to each peer that is ONLINE and is to be checked, one peer after the other. A large
/// one only if large datagrams were not seen to be lost: otherwise it would break the link.
void observe_links(Session& session, Observed seen, const ObservedNext& next);

/// The addresses to try: of the nodes to be checked in the routing table, of the seeds, and the one that the person
/// named. At most 64. Of a linked one the port is known.
std::vector<AddressProbe> addresses_to_try(const Observed& seen, const std::vector<std::string>& seeds,
                                           const std::function<bool(const std::string&)>& in_own_subnet);

}  // namespace trb::op
