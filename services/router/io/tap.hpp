// The tap: what passes this node, for `trb tap`.
#pragma once

#include <functional>
#include <optional>

#include "services/router/io/shell_context.hpp"

namespace trb::router {

/// Two frames per message: its direction (`<` in, `>` out, `=` inside) and the message. Nothing is copied while nobody
/// listens; what does not fit into a listener's queue is dropped and counted.
class Tap {
 public:
  explicit Tap(ShellContext& shell) : shell_(shell), budget_(shell.new_budget()) {}

  /// Opens it at this endpoint; empty: nowhere until socket() is bound. `curve`: the keys of a bus over TCP; ZAP must
  /// be bound before. Errors: io_error naming the endpoint.
  Status open(const std::string& endpoint, const CurveKeys* curve = nullptr);
  /// Only once it is open.
  [[nodiscard]] Socket& socket() { return *socket_; }
  /// Gets the descriptor of each connection that subscribes.
  void set_on_listener(std::function<void(int fd)> on_listener) { on_listener_ = std::move(on_listener); }
  void show(char direction, BytesView frame) {
    if (listeners_ > 0) send(direction, frame);
  }

 private:
  void send(char direction, BytesView frame);
  void drain();

  ShellContext& shell_;
  std::shared_ptr<ByteBudget> budget_;  ///< of all listeners: they share each message
  std::optional<Socket> socket_;
  std::function<void(int fd)> on_listener_;
  unsigned listeners_ = 0;
};

}  // namespace trb::router
