// One service of the session's node takes its files anew.
#pragma once

#include <functional>
#include <string>

#include "common/operator/session.hpp"

namespace trb::op {

struct ReloadService {
  std::string service;
  /// Asks the process to restart once it is idle. `missing`: it has ended already.
  std::function<Status(std::uint32_t pid)> ask;
  Duration wait = std::chrono::seconds(15);  ///< until it is up again
};

/// Asks the service's process to restart, and waits until its successor is up, which has read the files before that. A
/// service that is down is not asked: it reads them when it starts. Errors: no_service (the node has no such service),
/// timeout (it has not come back), those of `ask`, and those of Session::request.
void reload_service(Session& session, ReloadService order, Callback<ServiceEntry> done);

}  // namespace trb::op
