#include "common/transport/loop.hpp"

#include <ctime>

namespace trb {
namespace {

std::int64_t read_clock(clockid_t clock) {
  timespec time{};
  ::clock_gettime(clock, &time);
  return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

/// No deadline: look again after this long; costs nothing and guards against a clock that jumps.
constexpr std::chrono::milliseconds kLongest{10'000};

short to_zmq(short events) {
  // zmq::pollitem uses its own names for poll(2)'s events.
  return static_cast<short>(((events & 1) != 0 ? ZMQ_POLLIN : 0) | ((events & 4) != 0 ? ZMQ_POLLOUT : 0) | ZMQ_POLLERR);
}

short from_zmq(short events) {
  return static_cast<short>(((events & ZMQ_POLLIN) != 0 ? 1 : 0) | ((events & ZMQ_POLLOUT) != 0 ? 4 : 0) |
                            ((events & ZMQ_POLLERR) != 0 ? 8 : 0));
}

}  // namespace

Now read_clocks() {
  return {{read_clock(CLOCK_MONOTONIC)}, {read_clock(CLOCK_REALTIME)}};
}

void Loop::add_socket(void* socket, Ready ready) {
  sockets_[socket] = std::make_shared<Entry>(Entry{socket, -1, ZMQ_POLLIN, std::move(ready), {}});
  changed_ = true;
}

void Loop::remove_socket(void* socket) {
  sockets_.erase(socket);
  changed_ = true;
}

void Loop::add_fd(int fd, short events, ReadyEvents ready) {
  fds_[fd] = std::make_shared<Entry>(Entry{nullptr, fd, to_zmq(events), {}, std::move(ready)});
  changed_ = true;
}

void Loop::remove_fd(int fd) {
  fds_.erase(fd);
  changed_ = true;
}

void Loop::add_timer(std::function<std::optional<MonotonicTime>()> next, std::function<void(Now)> tick) {
  timers_.push_back({std::move(next), std::move(tick)});
}

bool Loop::turn() {
  if (stopped_) return false;
  if (changed_) rebuild();
  try {
    zmq::poll(items_, time_out());
  } catch (const zmq::error_t& problem) {
    if (problem.num() != EINTR) throw;
  }
  call_ready();
  call_timers();
  return !stopped_;
}

void Loop::rebuild() {
  changed_ = false;
  items_.clear();
  entries_.clear();
  const auto add = [this](const std::shared_ptr<Entry>& entry) {
    items_.push_back({entry->socket, entry->socket != nullptr ? 0 : entry->fd, entry->events, 0});
    entries_.push_back(entry);
  };
  for (const auto& [key, entry] : sockets_) add(entry);
  for (const auto& [key, entry] : fds_) add(entry);
}

void Loop::call_ready() {
  for (std::size_t i = 0; i < items_.size(); ++i) {
    if (items_[i].revents == 0) continue;
    const std::shared_ptr<Entry> entry = entries_[i];
    // A handler called before this one may have removed it.
    const bool alive = entry->socket != nullptr ? sockets_.count(entry->socket) != 0 && sockets_[entry->socket] == entry
                                                : fds_.count(entry->fd) != 0 && fds_[entry->fd] == entry;
    if (!alive) continue;
    if (entry->socket != nullptr) {
      entry->ready();
    } else {
      entry->ready_events(from_zmq(items_[i].revents));
    }
    items_[i].revents = 0;
  }
}

void Loop::call_timers() {
  std::optional<Now> now;
  for (std::size_t i = 0; i < timers_.size(); ++i) {
    const auto next = timers_[i].next();
    if (!next) continue;
    if (!now) now = read_clocks();
    if (*next <= now->mono) timers_[i].tick(*now);
  }
}

std::chrono::milliseconds Loop::time_out() const {
  std::optional<MonotonicTime> next;
  for (const Timer& timer : timers_) next = earlier(next, timer.next());
  if (!next) return kLongest;
  const Duration left = *next - read_clocks().mono;
  if (left <= Duration::zero()) return std::chrono::milliseconds(0);
  return std::min(kLongest, std::chrono::ceil<std::chrono::milliseconds>(left));
}

}  // namespace trb
