// What the doctor asks a node's router and the routers it is linked with.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/operator/doctor/diagnosis.hpp"
#include "common/operator/session.hpp"

namespace trb::op {

/// An answer to the doctor's questions: what was seen before, and what they added to it.
using ObservedNext = std::function<void(Observed)>;

/// Asks the own router for its table, its services, its links' troubles, and its scheduler for its runs. What is not
/// answered stays empty.
void observe_router(Session& session, Observed seen, const ObservedNext& next);

/// Sends echoes, small and large, over the link to each peer that is ONLINE and was asked for, one peer after the
/// other. A large one only where large datagrams were not seen to be lost: it would take the link with it.
void observe_links(Session& session, Observed seen, const ObservedNext& next);

/// The addresses to try: of the nodes in the routing table that were asked for, of the seeds, and the one that was
/// asked for. At most 64.
std::vector<AddressProbe> addresses_to_try(const Observed& seen, const std::vector<std::string>& seeds,
                                           const std::function<bool(const std::string&)>& in_own_subnet);

}  // namespace trb::op
