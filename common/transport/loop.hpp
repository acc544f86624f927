// The one poll loop: sockets, descriptors, deadlines. Its time-out is the earliest deadline, never an arbitrary tick.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>
#include <zmq.hpp>

#include "common/base/time.hpp"

namespace trb {

/// Reads both clocks of this machine.
Now read_clocks();

class Loop {
 public:
  using Ready = std::function<void()>;
  using ReadyEvents = std::function<void(short revents)>;

  /// `ready` is called while the socket can be read; it takes at most a bounded batch and returns.
  void add_socket(void* socket, Ready ready);
  void remove_socket(void* socket);
  /// poll(2) events; again with the same descriptor replaces them.
  void add_fd(int fd, short events, ReadyEvents ready);
  void remove_fd(int fd);
  void add_timer(std::function<std::optional<MonotonicTime>()> next, std::function<void(Now)> tick);

  /// One turn: waits for the next event or deadline, calls what is ready. False after stop().
  bool turn();
  void run() {
    while (turn()) {
    }
  }
  void stop() { stopped_ = true; }

 private:
  struct Entry {
    void* socket = nullptr;
    int fd = -1;
    short events = 0;
    Ready ready;
    ReadyEvents ready_events;
  };
  struct Timer {
    std::function<std::optional<MonotonicTime>()> next;
    std::function<void(Now)> tick;
  };

  void rebuild();
  void call_ready();
  void call_timers();
  [[nodiscard]] std::chrono::milliseconds time_out() const;

  std::map<void*, std::shared_ptr<Entry>> sockets_;
  std::map<int, std::shared_ptr<Entry>> fds_;
  std::vector<Timer> timers_;
  std::vector<zmq::pollitem_t> items_;
  std::vector<std::shared_ptr<Entry>> entries_;
  bool changed_ = true;
  bool stopped_ = false;
};

}  // namespace trb
