#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "services/virtual-robots/support/socket.hpp"

namespace trb::virtual_robots {

/** Seconds of the steady clock. */
double wall_seconds();

/** Asks for SIGTERM when the parent dies. False if the parent is no longer `parent`. */
bool die_with_parent(int parent);

/** Ignores SIGPIPE and turns SIGTERM and SIGINT into a readable descriptor, so that they end the poll loop. */
Fd catch_end_signals();

/**
 * One line on stdout, at once if stdout takes it. It never waits for a reader: lines are kept up to a
 * bound, then they are lost, which `lines_lost N` reports.
 */
void print_line(std::string_view line);

/** 1 while lines are kept, for a poll entry with POLLOUT; otherwise -1, which poll skips. */
int stdout_to_poll();

/** Writes what stdout takes of the kept lines. */
void flush_lines();

/** The poll time-out in milliseconds until `deadline`, rounded up so that the deadline has passed after it. */
int poll_timeout(double now, double deadline);

/** Complete lines of stdin, read when poll finds them. After its end the descriptor is -1, which poll skips. */
class StdinLines {
 public:
  int fd() const { return ended_ ? -1 : 0; }
  std::vector<std::string> read();

 private:
  std::string buffer_;
  bool ended_ = false;
};

}  // namespace trb::virtual_robots
