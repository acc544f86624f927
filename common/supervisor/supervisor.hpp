// Starts a node's services, keeps them running, ends them with itself.
#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/supervisor/restart_delay.hpp"
#include "common/supervisor/service_manager.hpp"

namespace trb::supervisor {

/// A program that is started as `PROGRAM NODE_DIR`, or with arguments of its own.
struct ServiceProgram {
  std::string service;
  std::string program;
  std::vector<std::string> arguments = {};  ///< empty: NODE_DIR
};

/// Blocks the signals that Supervisor::run() waits for; call it before the process has threads.
void block_signals();

class Supervisor {
 public:
  /// `notify` gets a line for the person: "ready", "router ended (signal 11), starting it again". `grace`: how long a
  /// service may take to end before it is killed.
  Supervisor(std::string node_dir, std::vector<ServiceProgram> services, std::function<void(const std::string&)> notify,
             Duration grace = std::chrono::seconds(3));

  /// The services that shall run from now on; empty: no change.
  using Reload = std::function<std::optional<std::vector<ServiceProgram>>()>;
  /// What is not up, in words for a person; empty: all services are.
  using WaitsFor = std::function<std::string()>;

  /// Called each round, which is every 10 s at least.
  void each_round(std::function<void()> call) { each_round_ = std::move(call); }

  /// Starts all services and keeps them running until SIGTERM or SIGINT. `reload` is called at SIGHUP; if it returns
  /// services, every service is asked to restart once it is idle, new ones are started, and removed ones end.
  /// `waits_for` is called every 0.1 s until all are up; it may take some tenths of a second. block_signals() must have
  /// been called before. Ends all services, by force after the grace, and returns 0. systemd hears that the services
  /// are ready, what they wait for, that this process is alive, and that it ends. A start that takes longer than
  /// `patience` counts as done for systemd, so that neither the computer's start nor apt waits for ever for a service
  /// that cannot start; its status still says what is not up.
  int run(const Reload& reload, const WaitsFor& waits_for, Duration patience = std::chrono::seconds(60));

 private:
  struct Child {
    std::string service;
    std::string program;
    std::vector<std::string> arguments;
    pid_t pid = 0;
    MonotonicTime started;
    MonotonicTime start_at;
    RestartDelay delay;
    bool wanted = true;                    ///< false: removed, to be ended
    std::optional<MonotonicTime> kill_at;  ///< of one that was asked to end
  };
  /// How far a start has come.
  struct Progress {
    MonotonicTime since;
    bool ready = false;
    bool late = false;  ///< systemd was told that the start is over, though it is not
  };
  void look(Progress& progress, const WaitsFor& waits_for, Duration patience);
  void add(ServiceProgram service);
  /// True if one is new.
  bool change(std::vector<ServiceProgram> services);
  void start_due(Now now);
  void reap(Now now);
  void kill_overdue(MonotonicTime now);
  void ended(Child& child, int status, Now now);
  void signal_all(int signal) const;
  void end_all();
  [[nodiscard]] Duration until_next(Now now, bool ready) const;

  std::string node_dir_;
  std::vector<Child> children_;
  std::function<void(const std::string&)> notify_;
  std::function<void()> each_round_;
  Duration grace_;
  ServiceManager manager_;
};

}  // namespace trb::supervisor
