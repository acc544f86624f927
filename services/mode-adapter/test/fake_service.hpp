// As much of a service as the robot's connections need, for tests over real sockets.
#pragma once

#include <poll.h>

#include <map>
#include <memory>

#include "common/service/test/loopless_service.hpp"
#include "services/mode-adapter/io/robot_io.hpp"
#include "services/mode-adapter/test/fixture.hpp"

namespace trb::adapter {

inline constexpr const char* kLoopback = "127.0.0.1";

/// As much of a service as the connections need: watches, timers, steps, and turns that the test requests.
class FakeService : public LooplessService {
 public:
  [[nodiscard]] std::uint64_t instance() const override { return kInstance; }
  void after_sends(std::function<void()> carry_out) override { after_sends_ = std::move(carry_out); }
  void watch(int fd, short events, std::function<void(short)> ready) override {
    watches_[fd] = {events, std::make_shared<std::function<void(short)>>(std::move(ready))};
  }
  void unwatch(int fd) override { watches_.erase(fd); }
  void timer(std::function<std::optional<MonotonicTime>()> next, std::function<void(Now)> tick) override {
    timers_.push_back({std::move(next), std::move(tick)});
  }
  [[nodiscard]] bool has_room() const override { return bus_has_room; }
  void step(const Effect& effect) override {
    Outbox out;
    effect(trb::now(), out);
    if (after_sends_) after_sends_();
    for (std::string& name : out.counts) counts.push_back(std::move(name));
    for (Log& log : out.logs) {
      told.push_back(log.event + " " + log.text);
      logs.push_back(std::move(log.event));
    }
  }

  /// Runs turns until it is true, for a minute at most.
  template <class Condition>
  bool until(Condition condition) {
    const MonotonicTime end = trb::now().mono + seconds(60);
    while (!condition()) {
      if (end < trb::now().mono) return false;
      turn();
    }
    return true;
  }

  [[nodiscard]] long logged(const std::string& event) const { return std::count(logs.begin(), logs.end(), event); }

  bool bus_has_room = true;
  std::vector<std::string> counts;
  std::vector<std::string> logs;
  std::vector<std::string> told;  ///< the same with their texts

 private:
  struct Watch {
    short events = 0;
    std::shared_ptr<std::function<void(short)>> ready;
  };
  struct Timer {
    std::function<std::optional<MonotonicTime>()> next;
    std::function<void(Now)> tick;
  };

  void turn() {
    std::vector<pollfd> fds;
    for (const auto& [fd, watch] : watches_) fds.push_back({fd, watch.events, 0});
    ::poll(fds.data(), fds.size(), 5);
    for (const pollfd& fd : fds) {
      const auto watch = watches_.find(fd.fd);
      if (fd.revents == 0 || watch == watches_.end()) continue;
      const auto ready = watch->second.ready;
      (*ready)(fd.revents);
    }
    for (const Timer& timer : timers_) {
      const auto next = timer.next();
      if (next && *next <= trb::now().mono) timer.tick(trb::now());
    }
  }

  std::map<int, Watch> watches_;
  std::vector<Timer> timers_;
  std::function<void()> after_sends_;
};

}  // namespace trb::adapter
