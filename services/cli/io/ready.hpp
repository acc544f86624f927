// Whether a node is up: its router answers, and says that every service of node.json is.
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>
#include <vector>

#include "services/cli/io/probe.hpp"

namespace trb::cli {

class ReadyCheck {
 public:
  explicit ReadyCheck(std::string dir) : dir_(std::move(dir)) {}
  bool operator()();
  /// What is not up, in words, as the last look has shown it; empty: all is.
  [[nodiscard]] const std::string& waits_for() const { return waits_for_; }
  /// What the services have to tell, as the last look has shown it: "scheduler waits: ...".
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  std::string dir_;
  std::unique_ptr<Probe> probe_;
  std::vector<std::string> notes_;
  std::string waits_for_ = "its router does not answer";
};

/// Waits until the node is ready that `supervisor`, a child of this process, starts; returns what its services have to
/// tell: one may be up, and wait for its files. Errors: timeout, naming what is
/// not up; conflict, if the supervisor has ended.
Result<std::vector<std::string>> wait_ready(const std::string& dir, pid_t supervisor, Duration wait);

/// Keeps log/up.log at 1 MiB or little more, with one older file beside it: what is too much moves there.
void bound_log(const std::string& node_dir);

/// In the child: a session of its own, its words go to NODE_DIR/log/up.log.
void leave_terminal(const std::string& node_dir);

/// Waits until no supervisor holds the node any more.
bool wait_down(const std::string& dir, Duration wait);

}  // namespace trb::cli
