// A process without free descriptors, for tests of what is created at run time.
#pragma once

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <cerrno>
#include <zmq.hpp>

namespace trb {

/// While this object exists, nothing in this process gets a new descriptor; open ones stay. The context's threads must
/// have been started before, by a socket.
class NoDescriptors {
 public:
  NoDescriptors() {
    // UBSan checks the first object of a class through a pipe, and reports it as invalid if there is no descriptor for
    // the pipe.
    REQUIRE(zmq::error_t(EMFILE).what() != nullptr);
    REQUIRE(::getrlimit(RLIMIT_NOFILE, &before_) == 0);
    const rlimit none{3, before_.rlim_max};
    REQUIRE(::setrlimit(RLIMIT_NOFILE, &none) == 0);
  }
  ~NoDescriptors() { ::setrlimit(RLIMIT_NOFILE, &before_); }
  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;

 private:
  rlimit before_{};
};

}  // namespace trb
