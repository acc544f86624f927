#include "services/cloud-gateway/io/loop_bridge.hpp"

#include <poll.h>

namespace trb::gateway {

LoopBridge::LoopBridge(boost::asio::io_context& loop, Driven driven)
    : descriptor_(loop, driven.descriptor), driven_(std::move(driven)) {}

LoopBridge::~LoopBridge() {
  descriptor_.release();
}

bool LoopBridge::serve(MonotonicTime now) {
  const auto due = driven_.next_deadline();
  if (ready_ || (due && *due <= now)) {
    ready_ = false;
    if (!driven_.handle_ready()) return false;
    // Asio waits for edges: what is left over would never wake it.
    ready_ = is_readable();
  }
  if (!ready_) wait();
  return true;
}

bool LoopBridge::is_readable() const {
  pollfd look{driven_.descriptor, POLLIN, 0};
  return ::poll(&look, 1, 0) > 0;
}

void LoopBridge::wait() {
  if (waiting_) return;
  waiting_ = true;
  descriptor_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                         [this](const boost::system::error_code& aborted) {
                           if (aborted) return;
                           waiting_ = false;
                           ready_ = true;
                         });
}

}  // namespace trb::gateway
