// A process around a core: a step's records are on disk before anything based on them leaves; meanwhile the process
// takes nothing in, as the real one does.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "common/actor/core.hpp"
#include "common/actor/journal_queue.hpp"
#include "services/simulator/world/clock.hpp"
#include "services/simulator/world/events.hpp"

namespace trb::world {

/// Where a process ends by itself. It outlives the process.
struct CrashPoint {
  std::size_t commits = 0;   ///< steps that have recorded something; what may wait is lost if it ends the process
  std::size_t at = 0;        ///< ends the process at this one; 0: never
  bool after_sends = false;  ///< of that step; otherwise they are lost
};

/// Where the effects of a core's steps go; whatever is left out does nothing.
struct ProcessSettings {
  std::function<void(Outbox& out)> inspect{};  ///< sees a step's effects first, and may change them
  const Duration* commit = nullptr;            ///< what writing a step's records takes, now; nullptr: no time
  std::function<void(const std::vector<Journal>&)> store{};  ///< puts them on disk
  std::function<void(const Send&)> send{};
  std::function<void()> after_sends{};
  CrashPoint* crash = nullptr;
  std::function<void()> on_crash{};  ///< ends the process: may destroy it
};

class CoreProcess {
 public:
  /// `core` must outlive it.
  CoreProcess(ProcessSettings settings, Core& core, Events& events, const Clock& clock);
  CoreProcess(const CoreProcess&) = delete;
  CoreProcess& operator=(const CoreProcess&) = delete;

  void welcome(const NodeIdentity& node);
  void take(const Inbound& message);
  /// Something else happens to the core.
  void step(const std::function<void(Now now, Outbox& out)>& call);
  /// At once; while it writes, when that is done.
  template <class What>
  void when_free(What&& what) {
    if (writes_) return void(waiting_.emplace_back(std::forward<What>(what)));
    what();
  }

 private:
  void commit(Outbox out);
  void write(const Outbox& out);
  void end_step(const Outbox& out);
  void send(const Outbox& out);
  void take_waiting();

  ProcessSettings settings_;
  Core& core_;
  Events& events_;
  const Clock& clock_;
  std::shared_ptr<char> life_ = std::make_shared<char>();
  Timer timer_;
  JournalQueue journal_;
  Timer commit_timer_;
  std::deque<Events::What> waiting_;
  bool writes_ = false;
};

}  // namespace trb::world
