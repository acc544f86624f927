#pragma once

#include <sys/types.h>

#include <string>

#include "common/base/result.hpp"

namespace trb::supervisor {

/// Only one supervisor a node: holds state/up.lock, which also carries its pid, for as long as it lives.
class NodeLock {
 public:
  /// Errors: conflict naming the pid of the one that holds it; io_error.
  static Result<NodeLock> take(const std::string& node_dir);
  /// The pid of the running supervisor. Errors: missing if none runs; io_error if one does, and its pid is not on disk.
  static Result<pid_t> holder(const std::string& node_dir);

  NodeLock(NodeLock&& other) noexcept : fd_(other.fd_) { other.fd_ = -1; }
  NodeLock(const NodeLock&) = delete;
  NodeLock& operator=(const NodeLock&) = delete;
  NodeLock& operator=(NodeLock&&) = delete;
  ~NodeLock();

 private:
  explicit NodeLock(int fd) : fd_(fd) {}
  int fd_;
};

}  // namespace trb::supervisor
