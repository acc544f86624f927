// Which run a message is about.
#pragma once

#include <string>

#include "proto/body.hpp"

namespace trb::scheduler {

/// Its id, also inside a signed order or decision; empty: of none.
std::string named_run(const Body& body);

}  // namespace trb::scheduler
