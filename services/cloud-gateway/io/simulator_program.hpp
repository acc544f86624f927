// trb-simulator as a child of this process.
#pragma once

#include <sys/types.h>

#include <string>

#include "common/base/result.hpp"

namespace trb::gateway {

/// A process that was started, and the ends that are read here; the caller closes them, and waits for it.
struct SimulatorProgram {
  pid_t pid = -1;
  int exit = -1;  ///< readable once the process has ended (pidfd)
  int answer = -1;
  int progress = -1;
};

/// Starts trb-simulator, which stands beside this program: in a group of its own, behind everything else (nice 19),
/// with 1 GiB of memory at most (but under a sanitizer), without any descriptor of this process, and ended by the
/// kernel when this process ends, however it does. Errors: missing (no such program), io_error.
Result<SimulatorProgram> start_simulator(const std::string& job);

/// Why a process that has ended gave no answer; `said`: what it has printed.
Error simulator_failure(int status, const std::string& said);

}  // namespace trb::gateway
