// The first password: made at the node's console, taken over by the gateway.
#pragma once

#include <string>

#include "services/cloud-gateway/io/gateway.hpp"

namespace trb::gateway {

/// NODE_DIR/keys/gateway.password, which `trb cloud password` writes (0600): {"user": NAME, "hash": HASH}. If it is
/// there, its user becomes an enabled admin with that password, who
/// has to take another one at the first sign-in; the audit log says so, by "console"; and the file is removed once that
/// is on disk. Errors: malformed, io_error.
Status take_bootstrap(Gateway& gateway);

}  // namespace trb::gateway
