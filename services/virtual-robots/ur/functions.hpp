#pragma once

#include "services/virtual-robots/ur/script.hpp"
#include "services/virtual-robots/ur/statement.hpp"

namespace trb::virtual_robots::ur {

/** Converts a call to its step. Throws CompileFailure: unknown function, wrong arguments. */
Step bind_call(const ScriptLine& line, const Call& call);

}  // namespace trb::virtual_robots::ur
