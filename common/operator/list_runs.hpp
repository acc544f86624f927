#pragma once

#include "common/operator/session.hpp"

namespace trb::op {

/// At most this many runs are listed; RunTable::more shows that there are others.
constexpr std::size_t kMostRunsListed = 10'000;

/// The runs that are not over on this node; with `all`, then those of its archive, newest first.
void list_runs(Session& session, bool all, const Callback<RunTable>& done);

}  // namespace trb::op
