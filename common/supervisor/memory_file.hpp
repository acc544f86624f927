// A file without a name, for what a child shall read: an argument has at most 128 KiB.
#pragma once

#include <string>

namespace trb::supervisor {

/// Has these bytes and is read from its beginning; closed in a child by exec. The caller closes it. Below 0: there is
/// none.
int memory_file(const std::string& bytes);

}  // namespace trb::supervisor
