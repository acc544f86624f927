// The worker's process: started, read, written to, killed and started again.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "common/base/descriptor.hpp"
#include "common/service/service.hpp"
#include "services/ros-bridge/core/bridge_core.hpp"

namespace trb::ros {

class WorkerProcess {
 public:
  /// `command` is the program and its arguments.
  WorkerProcess(Service& service, BridgeCore& core, std::vector<std::string> command);
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;
  ~WorkerProcess();

 private:
  void start(Now now);
  void carry_out(const WorkerOutput& output);
  void on_ready(short events);
  void flush();
  void watch();
  /// Kills it and waits for its end. The worker's exit status, if it ended by itself.
  std::optional<int> end();
  void ended(const std::string& reason, Duration pause);

  Service& service_;
  BridgeCore& core_;
  std::vector<std::string> command_;
  pid_t pid_ = 0;
  Descriptor fd_;
  Bytes unsent_;
  bool is_full_ = false;  ///< too much was unsent: the worker is given up
  MonotonicTime start_at_;
};

}  // namespace trb::ros
