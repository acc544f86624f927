// Whether a node is up: its router answers, and says that every service of node.json is.
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>

#include "services/cli/io/probe.hpp"

namespace trb::cli {

class ReadyCheck {
 public:
  explicit ReadyCheck(std::string dir) : dir_(std::move(dir)) {}
  bool operator()();
  /// What is not up, in words, as the last look has shown it; empty: all is.
  [[nodiscard]] const std::string& waits_for() const { return waits_for_; }

 private:
  std::string dir_;
  std::unique_ptr<Probe> probe_;
  std::string waits_for_ = "its router does not answer";
};

/// Waits until the node is ready that `supervisor`, a child of this process, starts. Errors: timeout, naming what is
/// not up; conflict, if the supervisor has ended.
Status wait_ready(const std::string& dir, pid_t supervisor, Duration wait);

/// In the child: a session of its own, its words go to NODE_DIR/log/up.log.
void leave_terminal(const std::string& node_dir);

/// Waits until no supervisor holds the node any more.
bool wait_down(const std::string& dir, Duration wait);

}  // namespace trb::cli
