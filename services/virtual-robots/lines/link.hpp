#pragma once

#include <string>
#include <string_view>

#include "services/virtual-robots/support/socket.hpp"

namespace trb::virtual_robots::lines {

/** The dialled connection to the node: connects, writes, reads, and dials again with back-off. */
class Link {
 public:
  enum class State { waiting, connecting, up };

  Link(Endpoint node, std::string source) : node_(std::move(node)), source_(std::move(source)) {}

  State state() const { return state_; }
  int fd() const { return socket_.get(); }
  double retry_at() const { return retry_at_; }

  /** Dials when it is due. */
  void dial(double now);

  /** Call it once the connecting socket is writable; true when the connection is up. */
  bool finish_dial(double now);

  void close(double now);

  /** Are there bytes that the socket has not taken yet? */
  bool has_output() const { return !output_.empty(); }
  void add_output(std::string_view bytes) { output_ += bytes; }

  /** Writes what the socket takes; false when the connection is gone. */
  bool flush();

  /** Reads what is there, up to a bound; false when the connection is gone. */
  bool read(std::string& bytes);

 private:
  Endpoint node_;
  std::string source_;
  Fd socket_;
  State state_ = State::waiting;
  double back_off_ = 0;
  double retry_at_ = 0;
  std::string output_;
};

}  // namespace trb::virtual_robots::lines
