// Files that are compiled into a program: cmake/embed.cmake.
#pragma once

#include <span>
#include <string_view>

namespace trb {

struct EmbeddedFile {
  std::string_view name;  ///< its path below the embedded folder
  std::string_view bytes;
  std::string_view gzipped;
};

}  // namespace trb
