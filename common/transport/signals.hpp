// Signals as events of the loop.
#pragma once

#include <functional>

#include "common/base/descriptor.hpp"
#include "common/transport/loop.hpp"

namespace trb {

/// Blocks SIGTERM, SIGINT, SIGHUP and SIGPIPE for this thread and all that it will start. Call before a Context is
/// made.
void block_signals();

/// Delivers SIGTERM, SIGINT and SIGHUP to the loop.
class Signals {
 public:
  Signals(Loop& loop, std::function<void(int signal)> on_signal);
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

 private:
  Loop& loop_;
  Descriptor fd_;
};

}  // namespace trb
