// `trb up`: starts a node's services, keeps them running, ends them with itself.
#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/time.hpp"

namespace trb::cli {

/// Only one supervisor a node: holds state/up.lock, which also carries its pid, for as long as it lives.
class NodeLock {
 public:
  /// Errors: conflict naming the pid of the one that holds it.
  static Result<NodeLock> take(const std::string& node_dir);
  /// The pid of the running supervisor. Errors: missing if none runs.
  static Result<pid_t> holder(const std::string& node_dir);

  NodeLock(NodeLock&& other) noexcept : fd_(other.fd_) { other.fd_ = -1; }
  NodeLock(const NodeLock&) = delete;
  NodeLock& operator=(const NodeLock&) = delete;
  NodeLock& operator=(NodeLock&&) = delete;
  ~NodeLock();

 private:
  explicit NodeLock(int fd) : fd_(fd) {}
  int fd_;
};

/// What is started as `PROGRAM NODE_DIR`.
struct ServiceProgram {
  std::string service;
  std::string program;
};

class Supervisor {
 public:
  /// `say` prints a line for the person.
  Supervisor(std::string node_dir, std::vector<ServiceProgram> services, std::function<void(const std::string&)> say);

  /// What is to run from now on; nothing: as it was.
  using Reload = std::function<std::optional<std::vector<ServiceProgram>>()>;

  /// Starts all and keeps them running until SIGTERM or SIGINT. `reload` is asked at SIGHUP; if it agrees, every
  /// service is asked to start again once it is idle, a new one is started, and one that is there no more ends. Signals
  /// must be blocked (block_signals plus SIGCHLD) before.
  int run(const Reload& reload, const std::function<bool()>& is_ready);

 private:
  struct Child {
    std::string service;
    std::string program;
    pid_t pid = 0;
    MonotonicTime started;
    Duration wait{};
    MonotonicTime start_at;
    bool wanted = true;  ///< false: taken out, and ends
  };
  /// True if one is new.
  bool change(std::vector<ServiceProgram> services);
  void start_due(Now now);
  void reap(Now now);
  void ended(Child& child, int status, Now now);
  void signal_all(int signal) const;
  void end_all();
  [[nodiscard]] Duration until_next(Now now, bool ready) const;

  std::string node_dir_;
  std::vector<Child> children_;
  std::function<void(const std::string&)> say_;
};

/// The folder of the running program.
std::string program_dir();

/// Asks the kernel to send SIGTERM to this process when its parent ends; ends at once if that has happened already.
void die_with_parent();

}  // namespace trb::cli
