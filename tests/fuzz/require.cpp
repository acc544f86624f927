#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/target.hpp"

namespace trb::fuzz {

void require(bool holds, const char* invariant) {
  if (holds) return;
  std::fprintf(stderr, "broken: %s\n", invariant);
  std::abort();
}

}  // namespace trb::fuzz
