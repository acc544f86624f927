#pragma once

#include <string>

#include "common/base/bytes.hpp"

namespace trb::op {

/// What a call to a cloud node with a code has brought.
struct DoorAnswer {
  enum class Kind : unsigned char {
    offer,    ///< the cloud node knows the code
    goodbye,  ///< it answered, and gave no offer; `text` is its reason
    refused,  ///< it lets this key in no more, for ten seconds
    nobody,   ///< no connection, or who answers does not have the key in the code
    silent,   ///< connected, but no answer in time
  } kind{};
  Bytes offer;
  std::string text;
};

}  // namespace trb::op
