#pragma once

#include <sys/types.h>

#include <string>
#include <utility>

#include "common/base/descriptor.hpp"
#include "common/base/result.hpp"

namespace trb::supervisor {

/// Only one supervisor a node: while this object exists it holds state/up.lock, which also has its pid.
class NodeLock {
 public:
  /// Errors: conflict naming the pid of the holder; io_error.
  static Result<NodeLock> take(const std::string& node_dir);
  /// The pid of the running supervisor, also if no byte of it could be written. Errors: missing if none runs; io_error
  /// if one runs whose pid cannot be known, or if this user may not look.
  static Result<pid_t> holder(const std::string& node_dir);

 private:
  explicit NodeLock(Descriptor file) : file_(std::move(file)) {}
  Descriptor file_;
};

}  // namespace trb::supervisor
