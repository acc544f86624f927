#include "common/service/message_ids.hpp"

#include <cstring>

#include "common/security/keys.hpp"

namespace trb {

std::uint64_t MessageIds::next(std::uint16_t slot) {
  if (used_ >= random_.size()) {
    const Bytes drawn = random_bytes(sizeof random_);
    std::memcpy(random_.data(), drawn.data(), sizeof random_);
    used_ = 0;
  }
  return static_cast<std::uint64_t>(slot) << 48U | static_cast<std::uint64_t>(random_[used_++]) << 16U | ++count_;
}

}  // namespace trb
