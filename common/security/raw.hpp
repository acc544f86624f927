// Bytes as libsodium takes them.
#pragma once

#include "common/base/bytes.hpp"

namespace trb {

inline const unsigned char* raw(BytesView bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}
inline unsigned char* raw(Bytes& bytes) {
  return reinterpret_cast<unsigned char*>(bytes.data());
}

}  // namespace trb
