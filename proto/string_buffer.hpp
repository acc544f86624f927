#pragma once

#include <string>

namespace trb {

/// Appends straight to a std::string: what msgpack's packer wants of its buffer.
struct StringBuffer {
  std::string& out;
  void write(const char* data, std::size_t size) { out.append(data, size); }
};

}  // namespace trb
