// Where a test finds the repository and its built programs.
#pragma once

#include <string>

namespace trb::test {

std::string source_dir();
std::string bin_dir();

}  // namespace trb::test
