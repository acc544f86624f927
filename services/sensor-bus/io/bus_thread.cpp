#include "services/sensor-bus/io/bus_thread.hpp"

#include <poll.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>

#include "services/sensor-bus/io/bell.hpp"
#include "services/sensor-bus/io/bus_connection.hpp"

namespace trb::sensor {
namespace {

using std::chrono::milliseconds;

constexpr Duration kFirstWait = milliseconds(100);
constexpr Duration kLongestWait = std::chrono::seconds(2);
constexpr Duration kPingEvery = std::chrono::seconds(5);
constexpr std::size_t kMostEvents = 4096;

int to_ms(Duration time) {
  return static_cast<int>(std::chrono::ceil<milliseconds>(std::max(time, Duration{})).count());
}

}  // namespace

struct BusThread::Shared {
  Bell for_thread;
  Bell for_loop;
  std::mutex mutex;
  std::condition_variable ended_changed;
  std::vector<Effect> effects;
  std::vector<BusEvent> events;
  std::size_t lost = 0;  ///< events for which there was no place
  bool stop = false;
  bool ended = false;

  void post(BusEvent one) {
    const bool must = std::holds_alternative<BusUp>(one) || std::holds_alternative<BusDown>(one);
    const std::lock_guard lock(mutex);
    if (!must && events.size() >= kMostEvents) {
      ++lost;
      return;
    }
    events.push_back(std::move(one));
    if (events.size() == 1) for_loop.ring();
  }
  /// The bus has come: what was wanted of its predecessor is not wanted any more.
  void report_up(std::string note) {
    {
      const std::lock_guard lock(mutex);
      effects.clear();
    }
    post(BusUp{std::move(note)});
  }
  std::vector<Effect> take_effects() {
    for_thread.silence();
    const std::lock_guard lock(mutex);
    return std::exchange(effects, {});
  }
  bool stopping() {
    const std::lock_guard lock(mutex);
    return stop;
  }
};

Result<std::unique_ptr<BusThread>> BusThread::open(std::string where, Service& service,
                                                   std::function<void(const std::vector<BusEvent>&)> tell) {
  auto shared = std::make_shared<Shared>();
  if (shared->for_thread.fd() < 0 || shared->for_loop.fd() < 0)
    return fail(Errc::io_error, "no eventfd", "raise the limit of open files");
  std::unique_ptr<BusThread> bus(new BusThread(shared, service, std::move(tell)));
  bus->thread_ = std::thread([where = std::move(where), shared] {
    run(where, *shared);
    const std::lock_guard lock(shared->mutex);
    shared->ended = true;
    shared->ended_changed.notify_all();
  });
  return bus;
}

BusThread::BusThread(std::shared_ptr<Shared> shared, Service& service,
                     std::function<void(const std::vector<BusEvent>&)> tell)
    : shared_(std::move(shared)), service_(service), tell_(std::move(tell)) {
  service_.watch(shared_->for_loop.fd(), POLLIN, [this](short) { on_bus_events(); });
}

BusThread::~BusThread() {
  service_.unwatch(shared_->for_loop.fd());
  std::unique_lock lock(shared_->mutex);
  shared_->stop = true;
  shared_->for_thread.ring();
  const bool ended = shared_->ended_changed.wait_for(lock, std::chrono::seconds(1), [this] { return shared_->ended; });
  lock.unlock();
  if (ended) {
    thread_.join();
  } else {
    thread_.detach();
  }
}

void BusThread::carry_out(std::vector<Effect> effects) {
  const std::lock_guard lock(shared_->mutex);
  for (Effect& effect : effects) shared_->effects.push_back(std::move(effect));
  shared_->for_thread.ring();
}

void BusThread::on_bus_events() {
  shared_->for_loop.silence();
  std::vector<BusEvent> events;
  {
    const std::lock_guard lock(shared_->mutex);
    events.swap(shared_->events);
    if (std::exchange(shared_->lost, 0) > 0)
      events.emplace_back(SignalRefused{"dropped.signals", "more than 4096 wait"});
  }
  tell_(events);
}

/// One connection after the other, with a pause that grows while there is none.
void BusThread::run(const std::string& where, Shared& shared) {
  Duration wait = kFirstWait;
  while (!shared.stopping()) {
    try {
      live(where, shared, wait);
      return;
    } catch (const std::exception& problem) {
      shared.post(BusDown{"the D-Bus \"" + where + "\": " + problem.what()});
    }
    pollfd bell{shared.for_thread.fd(), POLLIN, 0};
    const MonotonicTime until = trb::now().mono + wait;
    for (Duration left = wait; left > Duration::zero() && !shared.stopping(); left = until - trb::now().mono) {
      ::poll(&bell, 1, to_ms(left));
      shared.for_thread.silence();
    }
    wait = std::min<Duration>(2 * wait, kLongestWait);
  }
}

/// Ends when it is told to stop; throws when the connection is lost.
void BusThread::live(const std::string& where, Shared& shared, Duration& wait) {
  BusConnection connection(where, [&](BusEvent one) { shared.post(std::move(one)); });
  shared.report_up(connection.note());
  wait = kFirstWait;
  MonotonicTime next_ping = trb::now().mono + kPingEvery;
  while (!shared.stopping()) {
    for (const Effect& effect : shared.take_effects()) connection.carry_out(effect);
    if (trb::now().mono >= next_ping) {
      connection.ping();
      next_ping = trb::now().mono + kPingEvery;
    }
    const bool all_done = connection.process();
    int timeout = all_done ? to_ms(next_ping - trb::now().mono) : 0;
    std::vector<pollfd> fds{{shared.for_thread.fd(), POLLIN, 0}};
    for (const auto& one : connection.waits()) {
      fds.push_back({one.fd, one.events, 0});
      if (one.timeout_ms >= 0) timeout = std::min(timeout, one.timeout_ms);
    }
    ::poll(fds.data(), fds.size(), timeout);
  }
}

}  // namespace trb::sensor
