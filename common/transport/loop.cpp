#include "common/transport/loop.hpp"

#include <poll.h>
#include <sys/epoll.h>
#include <unistd.h>

#include <zmq.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <ctime>
#include <stdexcept>
#include <utility>

namespace trb {
namespace {

std::int64_t read_clock(clockid_t clock) {
  timespec time{};
  ::clock_gettime(clock, &time);
  return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

/// Without a deadline: wake after this long; costs nothing and guards against a clock that jumps.
constexpr std::chrono::milliseconds kLongest{10'000};

bool can_be_read(void* socket) {
  int events = 0;
  std::size_t size = sizeof events;
  return zmq_getsockopt(socket, ZMQ_EVENTS, &events, &size) == 0 && (events & ZMQ_POLLIN) != 0;
}

int descriptor_of(void* socket) {
  int fd = -1;
  std::size_t size = sizeof fd;
  if (zmq_getsockopt(socket, ZMQ_FD, &fd, &size) != 0) throw std::runtime_error("a socket has no descriptor");
  return fd;
}

}  // namespace

Now read_clocks() {
  return {{read_clock(CLOCK_MONOTONIC)}, {read_clock(CLOCK_REALTIME)}};
}

Loop::Loop() : epoll_(::epoll_create1(EPOLL_CLOEXEC)) {
  if (epoll_ < 0) throw std::runtime_error("epoll_create1 failed");
}

Loop::~Loop() {
  ::close(epoll_);
}

void Loop::add_socket(void* socket, Ready ready, std::shared_ptr<Unseen> unseen) {
  add_socket(socket, std::move(ready), std::move(unseen), false);
}

void Loop::add_background_socket(void* socket, Ready ready, std::shared_ptr<Unseen> unseen) {
  add_socket(socket, std::move(ready), std::move(unseen), true);
}

void Loop::add_socket(void* socket, Ready ready, std::shared_ptr<Unseen> unseen, bool background) {
  remove_socket(socket);
  auto entry = std::make_shared<Entry>(socket, descriptor_of(socket), short{EPOLLIN});
  entry->ready = std::move(ready);
  entry->is_counted = unseen == nullptr;
  entry->unseen = entry->is_counted ? std::make_shared<Unseen>() : std::move(unseen);
  entry->background = background;
  watch(*entry);
  entry->unseen->join(list_of(*entry), socket);
  sockets_[socket] = std::move(entry);
}

void Loop::remove_socket(void* socket) {
  const auto at = sockets_.find(socket);
  if (at == sockets_.end()) return;
  unwatch(*at->second);
  at->second->unseen->leave(list_of(*at->second));
  sockets_.erase(at);
}

void Loop::add_fd(int fd, short events, ReadyEvents ready) {
  remove_fd(fd);
  auto entry = std::make_shared<Entry>(nullptr, fd, events);
  entry->ready_events = std::move(ready);
  watch(*entry);
  fds_[fd] = std::move(entry);
}

void Loop::remove_fd(int fd) {
  const auto at = fds_.find(fd);
  if (at == fds_.end()) return;
  unwatch(*at->second);
  fds_.erase(at);
}

void Loop::watch(Entry& entry) {
  // poll(2) and epoll(7) have the same bits.
  const auto events = static_cast<std::uint32_t>(entry.events);
  epoll_event event{entry.background ? events | EPOLLET : events, {.ptr = &entry}};
  if (::epoll_ctl(epoll_, EPOLL_CTL_ADD, entry.fd, &event) != 0) throw std::runtime_error("epoll_ctl failed");
}

void Loop::unwatch(Entry& entry) {
  entry.removed = true;
  ::epoll_ctl(epoll_, EPOLL_CTL_DEL, entry.fd, nullptr);
}

void Loop::add_timer(std::function<std::optional<MonotonicTime>()> next, std::function<void(Now)> tick) {
  timers_.push_back({std::move(next), std::move(tick)});
}

bool Loop::turn() {
  if (stopped_) return false;
  const bool is_ready = look_at_unseen();
  const MonotonicTime now = read_clocks().mono;
  const auto longest = is_ready ? std::chrono::milliseconds(0) : time_out(next_timer(), now);
  stalls_.on_wait(now, now + longest);
  return serve(longest);
}

bool Loop::handle_ready() {
  if (stopped_) return false;
  look_at_unseen();
  return serve(std::chrono::milliseconds(0));
}

std::optional<MonotonicTime> Loop::next_deadline() {
  const auto next = look_at_unseen() ? MonotonicTime{0} : next_timer();
  const MonotonicTime now = read_clocks().mono;
  stalls_.on_wait(now, next.value_or(now + kLongest));
  return next;
}

bool Loop::serve(std::chrono::milliseconds longest) {
  Entries ready = wait(longest);
  call_ready(ready);
  ready.clear();
  spare_ = std::move(ready);
  call_timers();
  return !stopped_;
}

bool Loop::look_at_unseen() {
  std::erase_if(*unseen_, [this](void* socket) {
    Unseen& unseen = *sockets_.at(socket)->unseen;
    unseen.set(unseen && can_be_read(socket));
    if (!unseen) unseen.unlisted();
    return !unseen;
  });
  return look_at_background() || !unseen_->empty();
}

/// Only the first is asked: those behind it cost a turn nothing.
bool Loop::look_at_background() {
  while (!background_->empty()) {
    void* const first = background_->front();
    Unseen& unseen = *sockets_.at(first)->unseen;
    unseen.set(unseen && can_be_read(first));
    if (unseen) return true;
    background_->erase(background_->begin());
    unseen.unlisted();
  }
  return false;
}

Loop::Entries Loop::wait(std::chrono::milliseconds longest) {
  // zmq_poll would ask every socket twice, a system call each.
  std::array<epoll_event, 64> events;
  const auto look = [&](std::chrono::milliseconds most) {
    const int count =
        ::epoll_wait(epoll_, events.data(), static_cast<int>(events.size()), static_cast<int>(most.count()));
    if (count < 0 && errno != EINTR) throw std::runtime_error("epoll_wait failed");
    return static_cast<std::size_t>(std::max(0, count));
  };
  std::size_t count = look(longest);
  stalls_.on_look(read_clocks().mono);
  // A handler may run a turn of its own: that one gets a new list.
  Entries ready = std::exchange(spare_, {});
  ++turn_;
  // What may wait hides nothing that may not.
  while (gather(ready, {events.data(), count}) && count == events.size()) count = look(std::chrono::milliseconds(0));
  for (void* socket : *unseen_) add(ready, *sockets_.at(socket));
  std::ranges::sort(ready, {}, [](const auto& entry) { return entry->place(); });
  return ready;
}

/// True if one of them may wait: it does so in `background_`, and is not reported again until it was read empty.
bool Loop::gather(Entries& ready, std::span<const epoll_event> events) const {
  bool may_wait = false;
  for (const epoll_event& event : events) {
    auto& entry = *static_cast<Entry*>(event.data.ptr);
    if (entry.background) {
      entry.unseen->set(true);
      may_wait = true;
      continue;
    }
    entry.revents = static_cast<short>(event.events);
    add(ready, entry);
  }
  return may_wait;
}

void Loop::add(Entries& ready, Entry& entry) const {
  if (std::exchange(entry.turn, turn_) != turn_) ready.push_back(entry.shared_from_this());
}

void Loop::call_ready(const Entries& ready) {
  for (const auto& entry : ready) {
    // A handler called before this one may have removed it and freed what it watched, or have read it empty.
    if (entry->is_ready()) call(*entry);
  }
  call_background();
}

void Loop::call_background() {
  while (!background_->empty()) {
    const std::shared_ptr<Entry> first = sockets_.at(background_->front());
    // It stays in the list, the last now: a handler may run a turn of its own.
    std::ranges::rotate(*background_, background_->begin() + 1);
    if (*first->unseen) return call(*first);
    background_->pop_back();
    first->unseen->unlisted();
  }
}

void Loop::call(Entry& entry) {
  const short revents = std::exchange(entry.revents, short{0});
  if (entry.socket == nullptr) return entry.ready_events(revents);
  if (entry.is_counted) entry.unseen->set(true);
  entry.ready();
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

std::optional<MonotonicTime> Loop::next_timer() const {
  std::optional<MonotonicTime> next;
  for (const Timer& timer : timers_) next = earlier(next, timer.next());
  return next;
}

std::chrono::milliseconds Loop::time_out(std::optional<MonotonicTime> next, MonotonicTime now) {
  if (!next) return kLongest;
  const Duration left = *next - now;
  if (left <= Duration::zero()) return std::chrono::milliseconds(0);
  return std::min(kLongest, std::chrono::ceil<std::chrono::milliseconds>(left));
}

}  // namespace trb
