#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include "tests/support/paths.hpp"

namespace trb::test {

std::string source_dir() {
  return TRB_SOURCE_DIR;
}
std::string bin_dir() {
  return TRB_BIN_DIR;
}

}  // namespace trb::test
