// The one poll loop: sockets, descriptors, deadlines. Its time-out is the earliest deadline, never an arbitrary tick.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "common/base/time.hpp"
#include "common/transport/stall_watch.hpp"
#include "common/transport/unseen.hpp"

struct epoll_event;

namespace trb {

/// Reads both clocks of this machine.
Now read_clocks();

class Loop {
 public:
  using Ready = std::function<void()>;
  using ReadyEvents = std::function<void(short revents)>;

  Loop();
  ~Loop();
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;

  /// `ready` is called when there may be something to read; it takes at most a bounded batch and returns. A ZeroMQ
  /// descriptor signals a message only until the socket is used for anything: `unseen` is true while one may wait
  /// without a signal (see Socket::unseen). If `unseen` is not given, only `ready` may use the socket.
  void add_socket(void* socket, Ready ready, std::shared_ptr<Unseen> unseen = nullptr);
  /// The same at low priority: of all these that are ready, one is called a turn, after everything else, round robin;
  /// the one that became ready first comes first.
  void add_background_socket(void* socket, Ready ready, std::shared_ptr<Unseen> unseen);
  void remove_socket(void* socket);
  /// poll(2) events; a second call with the same descriptor replaces them.
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

  /// For a program with an event loop of its own, instead of turn(): it watches this descriptor for reading, and calls
  /// handle_ready() when it is readable or when next_deadline() has come.
  [[nodiscard]] int descriptor() const { return epoll_; }
  /// Ask before each wait: a deadline in the past means that something is ready that the descriptor does not signal.
  /// Empty: only the descriptor wakes it.
  [[nodiscard]] std::optional<MonotonicTime> next_deadline();
  /// Calls what is ready and what is due, and never waits. False after stop().
  bool handle_ready();

  /// How long what a handler reads now may have waited for this loop: StallWatch.
  [[nodiscard]] Duration waited(MonotonicTime now) const { return stalls_.waited(now); }

 private:
  struct Entry : std::enable_shared_from_this<Entry> {
    Entry(void* its_socket, int its_fd, short its_events) : socket(its_socket), fd(its_fd), events(its_events) {}

    void* const socket;  ///< nullptr: a descriptor
    const int fd;
    const short events;
    Ready ready;
    ReadyEvents ready_events;
    std::shared_ptr<Unseen> unseen;  ///< of a socket
    bool is_counted = false;         ///< `unseen` is the loop's: it is set when `ready` is called
    short revents = 0;               ///< of this turn
    std::uint64_t turn = 0;          ///< in whose list it was last
    bool removed = false;
    bool background = false;  ///< its descriptor is reported once; then it waits in `background_`

    /// Its place in a turn: sockets come before descriptors.
    [[nodiscard]] std::tuple<bool, std::uintptr_t, int> place() const {
      return {socket == nullptr, reinterpret_cast<std::uintptr_t>(socket), fd};
    }
    [[nodiscard]] bool is_ready() const { return !removed && (revents != 0 || (unseen != nullptr && *unseen)); }
  };
  using Entries = std::vector<std::shared_ptr<Entry>>;
  struct Timer {
    std::function<std::optional<MonotonicTime>()> next;
    std::function<void(Now)> tick;
  };

  void add_socket(void* socket, Ready ready, std::shared_ptr<Unseen> unseen, bool background);
  [[nodiscard]] const std::shared_ptr<Unseen::List>& list_of(const Entry& entry) const {
    return entry.background ? background_ : unseen_;
  }
  void watch(Entry& entry);
  void unwatch(Entry& entry);
  /// True if a socket has something to read that its descriptor does not signal.
  bool look_at_unseen();
  bool look_at_background();
  bool serve(std::chrono::milliseconds longest);
  /// What is ready, in the order of the calls.
  [[nodiscard]] Entries wait(std::chrono::milliseconds longest);
  bool gather(Entries& ready, std::span<const epoll_event> events) const;
  void add(Entries& ready, Entry& entry) const;
  void call_ready(const Entries& ready);
  void call_background();
  static void call(Entry& entry);
  void call_timers();
  [[nodiscard]] std::optional<MonotonicTime> next_timer() const;
  [[nodiscard]] static std::chrono::milliseconds time_out(std::optional<MonotonicTime> next, MonotonicTime now);

  std::unordered_map<void*, std::shared_ptr<Entry>> sockets_;
  /// Those that may have a message that is not signalled; shared, as a socket may outlive the loop.
  const std::shared_ptr<Unseen::List> unseen_ = std::make_shared<Unseen::List>();
  /// Those of low priority that may have something, in the order of their calls.
  const std::shared_ptr<Unseen::List> background_ = std::make_shared<Unseen::List>();
  std::map<int, std::shared_ptr<Entry>> fds_;
  std::vector<Timer> timers_;
  std::uint64_t turn_ = 0;  ///< counts them
  Entries spare_;           ///< the room of the last turn's list
  StallWatch stalls_;
  int epoll_;
  bool stopped_ = false;
};

}  // namespace trb
