// What a program asks the kernel about itself.
#pragma once

#include <string>

namespace trb::supervisor {

/// The folder of the running program.
std::string program_dir();

/// Asks the kernel to send SIGTERM to this process when its parent ends; exits at once if it has ended already.
void die_with_parent();

}  // namespace trb::supervisor
