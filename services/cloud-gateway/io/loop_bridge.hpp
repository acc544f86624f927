// A loop of ours (the service's, a session's) within an io_context, on the same thread.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <functional>
#include <optional>

#include "common/base/time.hpp"

namespace trb::gateway {

class LoopBridge {
 public:
  struct Driven {
    int descriptor = -1;  ///< readable: something is ready; stays its owner's
    std::function<std::optional<MonotonicTime>()> next_deadline;
    std::function<bool()> handle_ready;  ///< false: it has ended
  };
  LoopBridge(boost::asio::io_context& loop, Driven driven);
  LoopBridge(const LoopBridge&) = delete;
  LoopBridge& operator=(const LoopBridge&) = delete;
  ~LoopBridge();

  /// Between two handlers of the io_context: does what is ready and due. False: the driven loop has ended.
  bool serve(MonotonicTime now);
  /// In the past: something is ready of which Asio reports nothing.
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const {
    return ready_ ? MonotonicTime{} : driven_.next_deadline();
  }

 private:
  void wait();
  [[nodiscard]] bool is_readable() const;

  boost::asio::posix::stream_descriptor descriptor_;
  Driven driven_;
  bool ready_ = true;
  bool waiting_ = false;
};

}  // namespace trb::gateway
