// The tap: what passes this node, for `trb tap`.
#pragma once

#include <optional>

#include "services/router/io/shell_context.hpp"

namespace trb::router {

/// Two frames a message: its direction (`<` in, `>` out, `=` inside) and itself. Nothing is copied while nobody
/// listens; what does not fit into the queue of a listener is dropped and counted.
class Tap {
 public:
  explicit Tap(ShellContext& shell) : shell_(shell), budget_(shell.new_budget()) {}

  /// At this endpoint; empty: nowhere until socket() is bound. `curve`: the keys of a bus over TCP, ZAP must be bound
  /// before. Errors: io_error naming the endpoint.
  Status open(const std::string& endpoint, const CurveKeys* curve = nullptr);
  /// Once it is open.
  [[nodiscard]] Socket& socket() { return *socket_; }
  void show(char direction, BytesView frame) {
    if (listeners_ > 0) send(direction, frame);
  }

 private:
  void send(char direction, BytesView frame);
  void drain();

  ShellContext& shell_;
  std::shared_ptr<ByteBudget> budget_;  ///< of all who listen: they share each message
  std::optional<Socket> socket_;
  unsigned listeners_ = 0;
};

}  // namespace trb::router
