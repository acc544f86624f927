#pragma once

#include <functional>
#include <string>

#include "common/operator/session.hpp"

namespace trb::op {

/// Who chooses the robots of a run's tasks that name none, when they are due.
struct Binder {
  std::string node;     ///< empty: no node; they are bound at once
  std::string why_not;  ///< as text; empty if every task names its robot
};

/// The node that will be the decider of the run, if its resilience answers within 2 s.
void find_binder(Session& session, const Scenario& scenario, const RouteTable& table,
                 const std::function<void(Binder)>& found);

}  // namespace trb::op
