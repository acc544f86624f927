// What the programs of a bench that has roles do first, and with an error at last.
#pragma once

#include <signal.h>
#include <sys/prctl.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "common/security/keys.hpp"

namespace trb::bench {

/// Ends with its parent. The first word is the role, empty if there is none; `run` returns the exit code.
template <class Run>
int bench_main(const char* program, int argc, char** argv, const Run& run) {
  try {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    init_crypto();
    return run(argc > 1 ? argv[1] : "", std::vector<std::string>{argv + std::min(argc, 2), argv + argc});
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "%s: %s\n", program, problem.what());
    return 1;
  }
}

}  // namespace trb::bench
