// A process whose descriptors have run out, for the tests of what is made while it runs.
#pragma once

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <cerrno>
#include <zmq.hpp>

namespace trb {

/// While it is there, nothing in this process gets a new descriptor; what is open stays. The context's threads must
/// have been started before, by a socket.
class NoDescriptors {
 public:
  NoDescriptors() {
    // UBSan looks at the first object of a class through a pipe, and takes it for none if there is no descriptor for
    // one.
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
