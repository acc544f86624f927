// What a program asks the kernel about itself.
#pragma once

#include <sys/types.h>

#include <string>

namespace trb::supervisor {

/// The folder of the running program.
std::string program_dir();

/// Asks the kernel to send SIGTERM to this process when its parent ends; exits at once if it has ended already.
/// `parent`: who that was before the fork; 1 is a parent like others, for a node may be the first process of a
/// container.
void die_with_parent(pid_t parent);

}  // namespace trb::supervisor
