// A service of the node asked, by a signal, to read its files again.
#pragma once

#include <sys/types.h>

#include <string>

#include "common/base/result.hpp"

namespace trb::supervisor {

/// Asks the process of this service to restart once it is idle (SIGHUP), as `trb reload` does for all. Errors: missing
/// (it has ended), conflict (the pid is another program's, as in another container), not_permitted.
Status ask_to_reload(pid_t pid, const std::string& service);

}  // namespace trb::supervisor
