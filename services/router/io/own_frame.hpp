// The router's own messages as frames.
#pragma once

#include <optional>

#include "services/router/io/shell_context.hpp"

namespace trb::router {

/// Nothing (an error in the log and a counter) if its receiver would have to refuse it. The core makes no such message;
/// if it does, the link must not end by it.
std::optional<Bytes> encode_own(ShellContext& shell, const Message& message);

}  // namespace trb::router
