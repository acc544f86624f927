#pragma once

#include <sys/eventfd.h>
#include <unistd.h>

namespace trb::sensor {

/// Wakes whoever polls it.
class Bell {
 public:
  Bell() : fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}
  Bell(const Bell&) = delete;
  Bell& operator=(const Bell&) = delete;
  ~Bell() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int fd() const { return fd_; }
  void ring() const {
    if (::eventfd_write(fd_, 1) != 0) return;  // full: it rings already
  }
  void silence() const {
    eventfd_t count = 0;
    if (::eventfd_read(fd_, &count) != 0) return;  // it did not ring
  }

 private:
  int fd_;
};

}  // namespace trb::sensor
