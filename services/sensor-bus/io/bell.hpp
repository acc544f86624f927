#pragma once

#include <sys/eventfd.h>

#include "common/base/descriptor.hpp"

namespace trb::sensor {

/// Wakes whoever polls it.
class Bell {
 public:
  Bell() : fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}
  [[nodiscard]] int fd() const { return fd_.get(); }
  void ring() const {
    if (::eventfd_write(fd_.get(), 1) != 0) return;  // full: it rings already
  }
  void silence() const {
    eventfd_t count = 0;
    if (::eventfd_read(fd_.get(), &count) != 0) return;  // it did not ring
  }

 private:
  Descriptor fd_;
};

}  // namespace trb::sensor
